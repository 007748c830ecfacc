#pragma once

#include "hal/pantilt/canopen/sdo_client.hpp"
#include "hal/pantilt/pan_tilt.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::hal {

/// What stands in the way of an axis. From FirstAbort on, the SDO abort codes in the order of their table.
enum class CanopenProblem : std::uint8_t {
  None,
  NotTried,
  NoReply,
  NotADrive,
  NoMode,
  NoLimits,
  NoScale,
  NoPdo,
  StateTimeout,
  DriveFault,
  NotHomed,
  ZeroLost,
  HomingFailed,
  HomingTimeout,
  HeartbeatLost,
  BootUp,
  NotOperational,
  NotEnabled,
  PositionsSilent,
  EmergencyGeneric,
  EmergencyCurrent,
  EmergencyVoltage,
  EmergencyTemperature,
  EmergencyHardware,
  EmergencySoftware,
  EmergencyModules,
  EmergencyCommunication,
  EmergencyPositioning,
  EmergencyExternal,
  EmergencyVendor,
  FirstAbort,
};

/// The problem that an SDO abort with `code` is (CiA 301, "SDO abort codes").
[[nodiscard]] CanopenProblem abort_problem(std::uint32_t code) noexcept;

/// What an SDO abort code means ("object does not exist"); "unknown abort code" for one not in the standard.
[[nodiscard]] std::string_view sdo_abort_name(std::uint32_t code) noexcept;

/// The problem that an EMCY error code is; the code is not 0 (CiA 301 and 402, "error codes").
[[nodiscard]] CanopenProblem emergency_problem(std::uint16_t code) noexcept;

/// `problem` for a person; empty for None. Lives as long as the program.
[[nodiscard]] std::string_view problem_text(Axis axis, CanopenProblem problem) noexcept;

/// A part of a node's start-up: requests one after the other, each depending on what was answered.
class CanopenScript {
 public:
  CanopenScript() = default;
  CanopenScript(const CanopenScript&) = delete;
  CanopenScript& operator=(const CanopenScript&) = delete;
  virtual ~CanopenScript() = default;

  /// Starts over.
  virtual void begin(Stamp now) noexcept = 0;

  /// The request that is due; nothing when all are done. Must not change what it depends on.
  [[nodiscard]] virtual std::optional<SdoRequest> next() const noexcept = 0;

  /// Takes the answer to next(), which is Done or Aborted; anything but None ends the start-up.
  [[nodiscard]] virtual CanopenProblem on_result(const SdoResult& result, const SdoClient& client,
                                                 Stamp now) noexcept = 0;
};

}  // namespace slamsensor::hal
