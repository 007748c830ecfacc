#include "tests/contract/can_link_contract.hpp"

namespace slamsensor::tests {

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(CanLinkContract);

void CanLinkContract::SetUp() {
  MadeRig<CanLinkRig> made = GetParam().make();
  if (!made) {
    GTEST_SKIP() << "SKIPPED, the contract of CanLink was NOT tested on " << GetParam().name << ": "
                 << made.error();
  }
  rig_ = std::move(*made);
}

void CanLinkContract::step(hal::Stamp time) {
  rig_->pass(time);
  link().service(rig_->now());
}

bool CanLinkContract::step_until(const std::function<bool()>& done) {
  for (int i = 0; i < 5000; ++i) {
    if (done()) {
      return true;
    }
    step();
  }
  return done();
}

void CanLinkContract::come_up() {
  ASSERT_TRUE(step_until([this] { return link().is_up(); }));
}

std::vector<hal::CanFrame> CanLinkContract::receive(std::size_t count) {
  std::vector<hal::CanFrame> got;
  static_cast<void>(step_until([&] {
    const hal::CanRead read = link().receive();
    if (read.status == hal::LinkStatus::Ok) {
      got.push_back(read.frame);
    }
    return got.size() >= count;
  }));
  return got;
}

std::vector<hal::CanFrame> CanLinkContract::peer_receive(std::size_t count) {
  std::vector<hal::CanFrame> got;
  static_cast<void>(step_until([&] {
    const std::vector<hal::CanFrame> some = rig_->peer_receive();
    got.insert(got.end(), some.begin(), some.end());
    return got.size() >= count;
  }));
  return got;
}

void CanLinkContract::send(const hal::CanFrame& frame) {
  ASSERT_TRUE(step_until([&] { return link().send(frame) == hal::LinkStatus::Ok; }));
}

void CanLinkContract::cut_and_notice() {
  rig_->cut();
  ASSERT_TRUE(step_until([&] {
    static_cast<void>(link().receive());
    return !link().is_up();
  }));
}

}  // namespace slamsensor::tests
