#pragma once

#include "hal/rangefinder/benewake_config.hpp"
#include "hal/rangefinder/benewake_products.hpp"
#include "hal/rangefinder/dialogue.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::hal {

/// The start-up of a Benewake device, the same on every kind of line (TF03 manual, commands 01, 03, 05, 06,
/// 07, 4F). Settings are not saved in the device.
class BenewakeScript {
 public:
  enum class Step : unsigned { Version, Format, Baud, Reopen, Rate, OverRange, Output, Readings, Done };
  enum class Verdict : std::uint8_t { Answered, Refused, Foreign };

  /// Commands of less than the product are sent where the line takes none.
  BenewakeScript(const BenewakeConfig& config, BenewakeCommands commands) noexcept
      : config_(config), commands_(commands) {}

  /// See Script::compose. `wanted_baud`: to be set now, 0 for none. At Step::Reopen the caller has to go to
  /// that rate.
  [[nodiscard]] StepKind compose(Step step, std::uint32_t wanted_baud, Request& into) noexcept;

  /// What a whole command frame from the device says of the request under way.
  [[nodiscard]] Verdict judge(std::span<const std::uint8_t> reply) const noexcept;

 private:
  StepKind ask(Request& into, std::uint8_t id, std::span<const std::uint8_t> payload) noexcept;

  BenewakeConfig config_;
  BenewakeCommands commands_;
  std::array<std::uint8_t, 4> payload_{};
  std::size_t payload_size_ = 0;
  std::uint8_t asked_id_ = 0;
};

}  // namespace slamsensor::hal
