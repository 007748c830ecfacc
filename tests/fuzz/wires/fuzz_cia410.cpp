#include "hal/inclination/cia410.hpp"
#include "tests/fuzz/wires/fuzz_can_link.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace {

using namespace slamsensor::hal;  // NOLINT(google-build-using-namespace)

/// An inclinometer that answers its start-up, on a bus where anything else may turn up.
class InclinometerLink final : public slamsensor::tests::FuzzCanLink {
 public:
  InclinometerLink(std::span<const std::uint8_t> input, bool answers)
      : FuzzCanLink(input, {0x58A, 0x58A, 0x58A, 0x70A, 0x08A, 0x18A, 0x58B, 0x800}), answers_(answers) {}

  [[nodiscard]] CanRead receive() noexcept override {
    if (reply_) {
      const CanRead got{LinkStatus::Ok, *reply_, now()};
      reply_.reset();
      return got;
    }
    return FuzzCanLink::receive();
  }

  [[nodiscard]] LinkStatus send(const CanFrame& frame) noexcept override {
    const std::uint32_t index = le_number(frame, 1, 2);
    if (answers_ && frame.id == 0x60A && (index == 0x1000 || index == 0x6000)) {
      reply_ = frame;
      reply_->id = 0x58A;
      reply_->data[0] = 0x43;
      put_le(*reply_, 4, 4, index == 0x1000 ? 0x0003019A : 10);
    }
    return LinkStatus::Ok;
  }

 private:
  bool answers_;
  std::optional<CanFrame> reply_;
};

void require(bool promise) {
  if (!promise) {
    __builtin_trap();
  }
}

}  // namespace

// Whatever frames come, a measurement is an attitude of something that stands, and of the past; a driver that
// is not ready says why.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  InclinometerLink link({data + 1, size - 1}, (data[0] & 1U) != 0);
  const auto driver = Cia410Inclinometer::create({}, link);
  while (!link.is_over()) {
    link.pass_a_millisecond();
    (*driver)->step(link.now());
    if (const auto got = (*driver)->take()) {
      require(std::abs(got->roll_rad) < 0.5 * std::numbers::pi && got->stamp <= link.now());
      require(std::abs(got->pitch_rad) < 0.5 * std::numbers::pi);
    }
    require((*driver)->state() == DeviceState::Ready || !(*driver)->problem().empty());
  }
  return 0;
}
