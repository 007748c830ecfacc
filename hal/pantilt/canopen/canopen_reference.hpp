#pragma once

#include "hal/pantilt/canopen/canopen_config.hpp"
#include "hal/pantilt/canopen/canopen_script.hpp"

#include <cstdint>

namespace slamsensor::hal {

/// Drives an enabled axis to its reference when that is due, brings it into profile position mode and reads
/// where it stands (CiA 402, "Homing mode").
class CanopenReferenceScript final : public CanopenScript {
 public:
  /// All of them outlive this.
  CanopenReferenceScript(const CanopenConfig& config, const CanopenAxisConfig& axis) noexcept
      : config_(config), axis_(axis) {}

  /// `modes` as object 6502 tells them. Called before begin().
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

}  // namespace slamsensor::hal
