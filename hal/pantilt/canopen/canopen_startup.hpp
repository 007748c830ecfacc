#pragma once

#include "hal/pantilt/canopen/canopen_config.hpp"
#include "hal/pantilt/canopen/canopen_pdo.hpp"
#include "hal/pantilt/canopen/canopen_script.hpp"
#include "hal/pantilt/pan_tilt.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamsensor::hal {

/// What a drive said of itself, in the units of this program.
struct CanopenFacts {
  AxisInfo info;
  double rad_per_count = 0.0;  ///< negative when the sense is reversed
  double speed_units_per_rad = 0.0;
  std::int32_t window_counts = 0;
  DeviceName name;
  std::uint32_t modes = 0;  ///< object 6502
};

/// Asks a node what it is and what it can do.
class CanopenFactsScript final : public CanopenScript {
 public:
  /// Both outlive this.
  CanopenFactsScript(const CanopenConfig& config, const CanopenAxisConfig& axis,
                     CanopenCounters& counters) noexcept
      : config_(config), axis_(axis), counters_(counters) {}

  void begin(Stamp now) noexcept override;
  [[nodiscard]] std::optional<SdoRequest> next() const noexcept override;
  [[nodiscard]] CanopenProblem on_result(const SdoResult& result, const SdoClient& client,
                                         Stamp now) noexcept override;

  /// Valid when the script is done.
  [[nodiscard]] const CanopenFacts& facts() const noexcept { return facts_; }

 private:
  static constexpr std::size_t kReads = 14;

  [[nodiscard]] CanopenProblem conclude() noexcept;
  [[nodiscard]] CanopenProblem find_range() noexcept;
  [[nodiscard]] double scale() const noexcept;
  [[nodiscard]] std::optional<std::uint32_t> reported(SdoAddress address) const noexcept;

  const CanopenConfig& config_;
  const CanopenAxisConfig& axis_;
  CanopenCounters& counters_;
  std::size_t at_ = 0;
  std::array<std::optional<std::uint32_t>, kReads> values_{};
  CanopenFacts facts_;
};

/// Drives an enabled axis to its reference when that is due, brings it into profile position mode and reads
/// where it stands (CiA 402, "Homing mode").
class CanopenReferenceScript final : public CanopenScript {
 public:
  /// All of them outlive this.
  CanopenReferenceScript(const CanopenConfig& config, const CanopenAxisConfig& axis) noexcept
      : config_(config), axis_(axis) {}

  /// `modes` as object 6502 holds them. Called before begin().
  void set_modes(std::uint32_t modes) noexcept { modes_ = modes; }

  void begin(Stamp now) noexcept override;
  [[nodiscard]] std::optional<SdoRequest> next() const noexcept override;
  [[nodiscard]] CanopenProblem on_result(const SdoResult& result, const SdoClient& client,
                                         Stamp now) noexcept override;

  /// Counts; valid when the script is done.
  [[nodiscard]] std::int32_t position() const noexcept { return position_; }

 private:
  enum class Step : std::uint8_t {
    HomingMode,
    HomingShown,
    Homed,
    Method,
    Start,
    Wait,
    End,
    Mode,
    ModeShown,
    Position,
    Done
  };

  void enter(Step step, Stamp now) noexcept;
  [[nodiscard]] CanopenProblem on_shown(const SdoResult& result, Step next, Stamp now) noexcept;
  [[nodiscard]] CanopenProblem start_homing(Stamp now) noexcept;
  [[nodiscard]] CanopenProblem on_homing(std::uint32_t statusword, Stamp now) noexcept;

  const CanopenConfig& config_;
  const CanopenAxisConfig& axis_;
  std::uint32_t modes_ = 0;
  Step step_ = Step::Done;
  Stamp since_{};
  bool was_busy_ = false;
  bool had_zero_ = false;  // in an earlier start-up
  std::int32_t position_ = 0;
};

/// Brings a drive into its state Operation enabled, from whatever state, by looking at its statusword after
/// each controlword (CiA 402).
class CanopenEnableScript final : public CanopenScript {
 public:
  /// Outlives this.
  explicit CanopenEnableScript(const CanopenConfig& config) noexcept : config_(config) {}

  void begin(Stamp now) noexcept override;
  [[nodiscard]] std::optional<SdoRequest> next() const noexcept override;
  [[nodiscard]] CanopenProblem on_result(const SdoResult& result, const SdoClient& client,
                                         Stamp now) noexcept override;

 private:
  [[nodiscard]] CanopenProblem on_status(std::uint32_t statusword, Stamp now) noexcept;

  const CanopenConfig& config_;
  bool done_ = false;
  bool write_due_ = false;
  std::optional<std::uint16_t> command_;  // the last, or the one due
  Stamp begun_{};
  Stamp since_{};
};

/// Sets what a drive needs before it is enabled: heartbeat, mode, accelerations.
class CanopenSettingsScript final : public CanopenScript {
 public:
  /// All of them outlive this.
  CanopenSettingsScript(const CanopenConfig& config, const CanopenAxisConfig& axis,
                        CanopenCounters& counters) noexcept
      : config_(config), axis_(axis), counters_(counters) {}

  /// `acceleration_units_per_rad` is what the drive counts for 1 rad/s^2.
  void set_scale(double acceleration_units_per_rad) noexcept { scale_ = acceleration_units_per_rad; }

  /// Whether the node took the heartbeat time. Valid when the script is done.
  [[nodiscard]] bool has_heartbeat() const noexcept { return has_heartbeat_; }

  void begin(Stamp now) noexcept override;
  [[nodiscard]] std::optional<SdoRequest> next() const noexcept override;
  [[nodiscard]] CanopenProblem on_result(const SdoResult& result, const SdoClient& client,
                                         Stamp now) noexcept override;

 private:
  const CanopenConfig& config_;
  const CanopenAxisConfig& axis_;
  CanopenCounters& counters_;
  double scale_ = 1.0;
  std::uint8_t step_ = 0;
  bool has_heartbeat_ = false;
};

/// Takes one node from whatever it does to an enabled drive that knows where it stands.
class CanopenStartup {
 public:
  /// All of them outlive this.
  CanopenStartup(const CanopenConfig& config, const CanopenAxisConfig& axis, CanLink& link, SdoClient& sdo,
                 CanopenCounters& counters) noexcept;

  /// Starts over.
  void begin(Stamp now) noexcept;

  /// One step; anything but None means it has failed.
  [[nodiscard]] CanopenProblem step(Stamp now) noexcept;

  [[nodiscard]] bool is_done() const noexcept { return stage_ == Stage::Done; }

  /// Whether the node was commanded to start: SYNC may now be of use to it.
  [[nodiscard]] bool is_operational() const noexcept { return stage_ >= Stage::Enable; }

  [[nodiscard]] const CanopenFacts& facts() const noexcept { return facts_.facts(); }
  [[nodiscard]] const PdoMap& command_map() const noexcept { return receive_.map(); }
  [[nodiscard]] const PdoMap& position_map() const noexcept { return transmit_.map(); }
  [[nodiscard]] std::int32_t position() const noexcept { return reference_.position(); }
  [[nodiscard]] bool has_heartbeat() const noexcept { return settings_.has_heartbeat(); }

 private:
  enum class Stage : std::uint8_t {
    Stop,
    Facts,
    Settings,
    Receive,
    Transmit,
    Start,
    Enable,
    Reference,
    Done
  };

  [[nodiscard]] CanopenScript* script() noexcept;
  void enter(Stage stage, Stamp now) noexcept;
  void step_nmt(NmtCommand command, Stamp now) noexcept;

  const CanopenConfig& config_;
  const CanopenAxisConfig& axis_;
  CanLink& link_;
  SdoClient& sdo_;
  CanopenCounters& counters_;
  CanopenFactsScript facts_;
  CanopenSettingsScript settings_;
  CanopenPdoScript receive_;
  CanopenPdoScript transmit_;
  CanopenEnableScript enable_;
  CanopenReferenceScript reference_;
  Stage stage_ = Stage::Stop;
  bool nmt_sent_ = false;
  Stamp resume_{};
};

}  // namespace slamsensor::hal
