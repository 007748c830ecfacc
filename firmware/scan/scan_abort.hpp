#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slamsensor::firmware {

/// Why a pass was ended before its end.
enum class ScanAbort : std::uint8_t {
  PanTiltLost,
  RangefinderLost,
  MoveRefused,
  PanStalled,     ///< the pan axis was not there in time, or came to rest elsewhere
  TiltStalled,    ///< the same of the tilt axis
  LinesRejected,  ///< more than the allowed share of them
  HeadMoved,      ///< an axis that was to rest was pushed off its place
  CarrierMoved,   ///< the lines of the scan were not swept from one place: see MotionDetector
  TimingInDoubt,  ///< what was measured when is not known well enough: see ScanDoubt
  Held,           ///< scanning is not allowed any more
  Cancelled,      ///< on command
};
inline constexpr std::size_t kScanAborts = 11;

/// Lower snake case, in the order of the enumerators.
inline constexpr std::array<std::string_view, kScanAborts> kScanAbortNames = {
    "pan_tilt_lost", "rangefinder_lost", "move_refused",    "pan_stalled", "tilt_stalled", "lines_rejected",
    "head_moved",    "carrier_moved",    "timing_in_doubt", "held",        "cancelled"};

/// What puts the timing of a whole scan in doubt.
enum class ScanDoubt : std::uint8_t {
  Device,          ///< a device's samples cannot be timed: hal::Device::timing_doubt()
  PositionsLoose,  ///< the pan was known too loosely for its speed in too many lines
  LatencyUnknown,  ///< it was so because nothing has told the latency between the devices yet
  OtherLatency,    ///< what the lines saw shows another latency than is known
};
inline constexpr std::size_t kScanDoubts = 4;

/// A sentence for a person: which device it is, what happened and what to do about it. Lives as long as the
/// program.
[[nodiscard]] std::string_view describe(ScanDoubt doubt) noexcept;

/// Why no scan may be made. Each is set and lifted by itself; one of them is enough.
enum class HoldReason : std::uint8_t {
  InterlockOpen,  ///< the laser interlock is open, or cannot be read
  Paused,         ///< on command
  LeanUnknown,    ///< the inclinometer has told nothing, or nothing for too long
  LeansTooFar,    ///< the sensor leans by more than it may
};
inline constexpr std::size_t kHoldReasons = 4;

/// As above.
[[nodiscard]] std::string_view describe(HoldReason reason) noexcept;

}  // namespace slamsensor::firmware
