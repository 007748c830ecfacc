#include "hal/rangefinder/benewake_script.hpp"

#include "hal/rangefinder/benewake_frame.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace slamsensor::hal {
namespace {

constexpr std::uint8_t kVersion = 0x01;
constexpr std::uint8_t kRate = 0x03;
constexpr std::uint8_t kFormat = 0x05;
constexpr std::uint8_t kBaud = 0x06;
constexpr std::uint8_t kOutput = 0x07;
constexpr std::uint8_t kOverRange = 0x4F;
constexpr std::uint8_t kStandardFormat = 1;
constexpr std::uint8_t kOn = 1;
constexpr std::uint8_t kDone = 0;
constexpr std::size_t kVersionPayload = 3;

constexpr std::string_view kSilent =
    "no reply at any line rate tried; check cable, power, and that the "
    "device is set to this kind of line";
constexpr std::string_view kRefuses = "the device does not confirm its settings";
constexpr std::string_view kNothing = "no readings at any line rate tried; check cable, power, line rate";

bool is_round_rate(double rate_hz) noexcept {
  for (const double unit : {1.0, 10.0, 100.0, 1000.0}) {
    const double n = rate_hz / unit;
    if (n == std::floor(n) && n >= 1.0 && n <= 9.0) {
      return true;
    }
  }
  return rate_hz == 10000.0;
}

}  // namespace

StepKind BenewakeScript::ask(Request& into, std::uint8_t id, std::span<const std::uint8_t> payload) noexcept {
  asked_id_ = id;
  payload_size_ = payload.size();
  std::copy(payload.begin(), payload.end(), payload_.begin());
  into.size = write_benewake(id, payload, into.bytes);
  into.patience = config_.reply_patience;
  into.problem = kRefuses;
  return StepKind::Ask;
}

StepKind BenewakeScript::compose(Step step, std::uint32_t wanted_baud, Request& into) noexcept {
  if (step == Step::Done) {
    return StepKind::Done;
  }
  if (step == Step::Readings) {
    into.patience = std::chrono::seconds(1) + from_seconds(10.0 / config_.rate_hz);
    if (commands_ == BenewakeCommands::None) {
      into.if_silent = IfSilent::NextRate;
      into.problem = kNothing;
    }
    return StepKind::AwaitReadings;
  }
  if (commands_ == BenewakeCommands::None) {
    return StepKind::Skip;
  }
  const auto rate = static_cast<std::uint32_t>(config_.rate_hz);
  const auto byte = [](std::uint32_t value, int at) { return static_cast<std::uint8_t>(value >> (8 * at)); };
  switch (step) {
    case Step::Version: {
      const StepKind kind = ask(into, kVersion, {});
      into.patience = std::min<Stamp>(config_.reply_patience, std::chrono::milliseconds(400));
      into.if_silent = IfSilent::NextRate;
      into.problem = kSilent;
      return kind;
    }
    case Step::Format:
      return ask(into, kFormat, std::array{kStandardFormat});
    case Step::Baud: {
      if (wanted_baud == 0) {
        return StepKind::Skip;
      }
      const StepKind kind = ask(
          into, kBaud,
          std::array{byte(wanted_baud, 0), byte(wanted_baud, 1), byte(wanted_baud, 2), byte(wanted_baud, 3)});
      into.tries = 1;  // the answer may come at either rate
      into.if_silent = IfSilent::GoOn;
      return kind;
    }
    case Step::Reopen:
      if (wanted_baud == 0) {
        return StepKind::Skip;
      }
      into.tries = 1;
      into.patience = std::chrono::milliseconds(100);
      return StepKind::Ask;
    case Step::Rate:
      return ask(into, kRate, std::array{byte(rate, 0), byte(rate, 1)});
    case Step::OverRange:
      if (commands_ != BenewakeCommands::OverRange || config_.over_range_cm == 0) {
        return StepKind::Skip;
      }
      return ask(into, kOverRange,
                 std::array{byte(config_.over_range_cm, 0), byte(config_.over_range_cm, 1)});
    default:
      return ask(into, kOutput, std::array{kOn});
  }
}

BenewakeScript::Verdict BenewakeScript::judge(std::span<const std::uint8_t> reply) const noexcept {
  if (reply.size() < kBenewakeCommandMin || reply[2] != asked_id_) {
    return Verdict::Foreign;
  }
  const auto payload = reply.subspan(3, reply.size() - kBenewakeCommandMin);
  if (asked_id_ == kVersion) {
    return payload.size() == kVersionPayload ? Verdict::Answered : Verdict::Foreign;
  }
  const auto said = std::span(payload_).first(payload_size_);
  const bool is_echo = std::equal(payload.begin(), payload.end(), said.begin(), said.end());
  const bool is_done = asked_id_ == kOverRange && payload.size() == 1 && payload[0] == kDone;
  return is_echo || is_done ? Verdict::Answered : Verdict::Refused;
}

std::optional<InitError> benewake_config_error(const BenewakeConfig& config) {
  const BenewakeProduct& product = benewake_product(config.model);
  const std::string name(product.name);
  if (!is_round_rate(config.rate_hz) || config.rate_hz > product.rate_max_hz) {
    return InitError{name + ": rate_hz " + std::to_string(config.rate_hz) +
                     " is not n, 10 n, 100 n or 1000 n with n from 1 to 9, up to " +
                     std::to_string(product.rate_max_hz)};
  }
  return range_config_error(config.range);
}

BenewakeConfig with_product_limits(BenewakeConfig config) noexcept {
  if (config.range.weak_below == 0.0) {
    config.range.weak_below = benewake_product(config.model).weak_below;
  }
  return config;
}

}  // namespace slamsensor::hal
