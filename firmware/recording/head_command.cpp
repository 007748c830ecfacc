#include "firmware/recording/head_command.hpp"

#include <bit>

namespace slamsensor::firmware {
namespace {

core::Attitude unpacked(std::uint64_t argument) noexcept {
  const auto half = [](std::uint64_t bits) {
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  };
  return {half(argument >> 32U), half(argument)};
}

}  // namespace

void command(SensorHead& head, TapeCommand what, std::uint64_t argument) noexcept {
  switch (what) {
    case TapeCommand::RequestScan:
      return head.request_scan();
    case TapeCommand::Hold:
      return argument < kHoldReasons ? head.hold(static_cast<HoldReason>(argument)) : void();
    case TapeCommand::Release:
      return argument < kHoldReasons ? head.release(static_cast<HoldReason>(argument)) : void();
    case TapeCommand::SetMode:
      return argument <= static_cast<std::uint64_t>(ScanMode::OneShot)
                 ? head.set_mode(static_cast<ScanMode>(argument))
                 : void();
    case TapeCommand::AbortScan:
      return head.abort_scan();
    case TapeCommand::Incline:
      return head.incline(unpacked(argument));
  }
}

}  // namespace slamsensor::firmware
