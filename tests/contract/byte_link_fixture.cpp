#include "tests/contract/byte_link_contract.hpp"

#include <array>

namespace slamsensor::tests {

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ByteLinkContract);

void ByteLinkContract::SetUp() {
  MadeRig<ByteLinkRig> made = GetParam().make();
  if (!made) {
    GTEST_SKIP() << "SKIPPED, the contract of ByteLink was NOT tested on " << GetParam().name << ": "
                 << made.error();
  }
  rig_ = std::move(*made);
}

void ByteLinkContract::step(hal::Stamp time) {
  rig_->pass(time);
  link().service(rig_->now());
}

bool ByteLinkContract::step_until(const std::function<bool()>& done) {
  for (int i = 0; i < 20'000; ++i) {
    if (done()) {
      return true;
    }
    step();
  }
  return done();
}

void ByteLinkContract::come_up() {
  ASSERT_TRUE(step_until([this] { return link().is_up(); }));
}

Bytes ByteLinkContract::read_bytes(std::size_t count) {
  Bytes got;
  std::array<std::uint8_t, 64> some{};
  static_cast<void>(step_until([&] {
    const hal::ByteRead read = link().read(std::span(some).first(std::min(some.size(), count - got.size())));
    got.insert(got.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(read.count));
    return got.size() >= count;
  }));
  return got;
}

Bytes ByteLinkContract::peer_read_bytes(std::size_t count) {
  Bytes got;
  static_cast<void>(step_until([&] {
    const Bytes some = rig_->peer_read();
    got.insert(got.end(), some.begin(), some.end());
    return got.size() >= count;
  }));
  return got;
}

void ByteLinkContract::write_bytes(std::span<const std::uint8_t> bytes) {
  ASSERT_TRUE(step_until([&] { return link().write(bytes) == hal::LinkStatus::Ok; }));
}

void ByteLinkContract::cut_and_notice() {
  rig_->cut();
  std::array<std::uint8_t, 64> some{};
  ASSERT_TRUE(step_until([&] {
    static_cast<void>(link().read(some));
    return !link().is_up();
  }));
}

}  // namespace slamsensor::tests
