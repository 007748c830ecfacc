#pragma once

#include "hal/stamp.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/world/random.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// What can go wrong on the wire or in a device.
enum class FaultKind : std::uint8_t {
  // Any serial line (done by the line; the device does not know)
  DropByte,     ///< the next byte to the host is lost
  CorruptByte,  ///< the next byte to the host arrives with one bit turned
  DoubleByte,   ///< the next byte to the host arrives twice
  Noise,        ///< random bytes come to the host while the fault lasts
  Stall,        ///< bytes to the host are held back while the fault lasts, then come at line rate
  CableOut,     ///< hang-up while the fault lasts; what was on the line is lost
  // Any device
  PowerCycle,  ///< off while the fault lasts (silent), then starts up as from the mains
  Silence,     ///< hears and works, but sends nothing while the fault lasts
  BaudReset,   ///< the device is at its factory line rate from now on
  // A pan-tilt unit that is spoken to by command and reply
  SwallowReply,  ///< the next reply is lost
  DoubleReply,   ///< the next reply is sent twice
  LateReply,     ///< the next reply comes `duration` late
  LimitReport,   ///< a limit report stands in the middle of the next reply
  ResetError,    ///< the unit resets, and the reset ends with too few limit hits and an error
  MissedSteps,   ///< an obstacle: the axis is elsewhere than it reports, until the next reset
  Blocked,  ///< neither axis moves while the fault lasts, whatever is commanded; it reports where it stands
  MonitorMode,   ///< somebody started the unit's own automatic scan
  SettingsLost,  ///< echo on and verbose again, as after a restore of factory settings
  // A rangefinder
  NoReturns,    ///< nothing comes back while the fault lasts
  WeakSignal,   ///< echoes too faint to be trusted while the fault lasts
  Saturation,   ///< echoes too bright while the fault lasts
  BadChecksum,  ///< the next record carries a wrong checksum
  StreamStops,  ///< the device stops streaming and waits for commands
  TextMessage,  ///< unasked text between the records
  DeviceError,  ///< the device reports an error instead of readings while the fault lasts
  // CAN
  InterfaceDown,  ///< the interface is down while the fault lasts
  BusOff,         ///< the host's controller goes bus-off and comes back when the fault ends
  LostFrame,      ///< the next frame to the host is lost
  Emergency,      ///< a drive reports an emergency and goes to its fault state
  SdoAbort,       ///< the next SDO request is aborted
  SdoSilence,     ///< the next SDO request is not answered
  NodeReset,      ///< a drive restarts by itself: boot-up message, all settings lost
  HeartbeatLost,  ///< a drive sends no heartbeat while the fault lasts, but works
};

inline constexpr std::size_t kFaultKinds = static_cast<std::size_t>(FaultKind::HeartbeatLost) + 1;

/// "drop_byte", "power_cycle", ... as written in scenario files; in the order of the enumerators.
[[nodiscard]] std::string_view name_of(FaultKind kind) noexcept;

/// A fault as it is handed to a device: from `at` on, for `duration` where the kind lasts.
struct Fault {
  FaultKind kind = FaultKind::DropByte;
  std::chrono::nanoseconds at{};
  std::chrono::nanoseconds duration{};
};

/// A fault at a given time, counted from the start of the scenario, in the device (or bus) of that name.
struct PlannedFault {
  std::string device;
  FaultKind kind = FaultKind::DropByte;
  double at_s = 0.0;
  double duration_s = 0.0;
};

/// When the faults of a rate come.
enum class FaultRhythm : std::uint8_t {
  Chance,   ///< a Poisson process: independent of each other
  Regular,  ///< every `mean_gap_s` exactly
};

/// Faults of one kind that come again and again from `from_s` until `until_s`.
struct FaultRate {
  std::string device;
  FaultKind kind = FaultKind::DropByte;
  FaultRhythm rhythm = FaultRhythm::Chance;
  double mean_gap_s = 60.0;
  double from_s = 0.0;
  double until_s = 1e9;
  double duration_s = 0.0;
};

/// A fault that is due.
struct DueFault {
  std::string device;
  Fault fault;
};

/// The faults of a scenario as one stream in the order of time. Each rate has its own random stream. Equal
/// arguments, equal faults.
class FaultPlan {
 public:
  FaultPlan() = default;
  FaultPlan(std::span<const PlannedFault> planned, std::span<const FaultRate> rates, std::uint64_t seed);

  /// When the next fault is due; hal::kNever when there are no more.
  [[nodiscard]] hal::Stamp next() const noexcept;

  /// The next fault when it is due at `now`, taken out of the stream.
  [[nodiscard]] std::optional<DueFault> take(hal::Stamp now);

 private:
  struct Source {
    FaultRate rate;
    Random rng;
    double next_s;

    void draw_next();
  };

  [[nodiscard]] const Source* earliest_source() const noexcept;

  std::vector<PlannedFault> planned_;  // the last is the next
  std::vector<Source> sources_;
};

/// Empty when `device` ("ptu", "rangefinder", "can") of `head` can have the fault `kind`; else what is wrong
/// with it.
[[nodiscard]] std::string misfit(const HeadProfile& head, std::string_view device, FaultKind kind);

}  // namespace slamsensor::tools
