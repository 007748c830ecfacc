#pragma once

#include "hal/pantilt/canopen/canopen_config.hpp"
#include "hal/pantilt/canopen/canopen_script.hpp"

#include <cstdint>

namespace slamsensor::hal {

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

}  // namespace slamsensor::hal
