#include "firmware/recording/head_command.hpp"

namespace slamsensor::firmware {

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
  }
}

}  // namespace slamsensor::firmware
