#include "hal/rangefinder/lwnx_script.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr std::array<std::uint8_t, 5> kWake = {'w', 'w', 'w', '\r', '\n'};
constexpr double kLineShare = 0.98;  // of the line that readings may take
constexpr std::string_view kSilent =
    "no reply at any line rate tried; check cable, power and that the device is on its serial interface";
constexpr std::string_view kRefuses = "the device does not confirm its settings";
constexpr std::string_view kUnknown =
    "the device speaks LWNX, but its product name is not known; a product of the table is needed";
constexpr std::string_view kLineTooSlow =
    "the device's line rate is too low for the readings asked for; lower the rate or let the driver change "
    "the baud rate";
constexpr std::string_view kNotThisMode = "this product does not have the configured mode of readings";

}  // namespace

StepKind LwnxScript::read(Request& into, std::uint8_t id) noexcept {
  into.size = write_lwnx(id, LwnxAccess::Read, {}, into.bytes);
  into.patience = config_.reply_patience;
  into.problem = kRefuses;
  asked_id_ = id;
  asked_width_ = 0;
  return StepKind::Ask;
}

StepKind LwnxScript::write(Request& into, std::uint8_t id, std::uint32_t value, std::size_t width) noexcept {
  if (id == 0) {
    return StepKind::Skip;
  }
  asked_id_ = id;
  asked_width_ = width;
  put_lwnx_value(value, asked_value_);
  into.size = write_lwnx(id, LwnxAccess::Write, std::span(asked_value_).first(width), into.bytes);
  into.patience = config_.reply_patience;
  into.tries = 5;
  into.problem = kRefuses;
  return StepKind::Ask;
}

StepKind LwnxScript::compose(Step step, std::uint32_t baud, Request& into) noexcept {
  switch (step) {
    case Step::Wake:
      into.say(kWake);
      into.patience = config_.reply_patience;
      into.tries = 1;
      into.if_silent = IfSilent::GoOn;
      return StepKind::Ask;
    case Step::Name: {
      const StepKind kind = read(into, lwnx_id::kProductName);
      // The LW20 lets the first requests after power-up go unanswered.
      into.tries = 6;
      into.if_silent = IfSilent::NextRate;
      into.problem = kSilent;
      return kind;
    }
    case Step::Quiet:
      return write(into, lwnx_id::kStream, kLwnxStreamOff, 4);
    case Step::Done:
      baud_was_changed_ = false;  // if it ever comes back at the old rate, once more
      return StepKind::Done;
    default:
      break;
  }
  if (product_ == nullptr) {
    return StepKind::Skip;
  }
  return step <= Step::Reopen ? compose_baud(step, baud, into) : compose_settings(step, into);
}

bool LwnxScript::changes_baud(std::uint32_t baud) const noexcept {
  return config_.baud_policy == BaudPolicy::Change && !baud_was_changed_ && product_->baud_id != 0 &&
         baud != config_.baud;
}

StepKind LwnxScript::compose_baud(Step step, std::uint32_t baud, Request& into) noexcept {
  if (!changes_baud(baud)) {
    return StepKind::Skip;
  }
  switch (step) {
    case Step::Baud: {
      const auto* const code = std::find(kLwnxBauds.begin(), kLwnxBauds.end(), config_.baud);
      return write(into, product_->baud_id, static_cast<std::uint32_t>(code - kLwnxBauds.begin()), 1);
    }
    case Step::BaudToken:
    case Step::ResetToken:
      return read(into, lwnx_id::kToken);
    case Step::Save:
    case Step::Reset: {
      const StepKind kind = write(into, step == Step::Save ? lwnx_id::kSave : lwnx_id::kReset, token_, 2);
      asked_width_ = 0;
      into.tries = 1;  // a token works once
      into.if_silent = IfSilent::GoOn;
      return kind;
    }
    default:
      baud_was_changed_ = true;
      into.tries = 1;
      into.patience = std::chrono::milliseconds(500);
      return StepKind::Ask;
  }
}

StepKind LwnxScript::compose_settings(Step step, Request& into) noexcept {
  if (!product_->is_documented && step < Step::Stream) {
    into.if_silent = IfSilent::GoOn;
  }
  switch (step) {
    case Step::RawMode:
      if (!is_raw()) {
        into.if_silent = IfSilent::GoOn;  // firmware before 1.5.0 has no such mode to leave
      }
      return write(into, product_->raw_mode_id, is_raw() ? 1 : 0, 1);
    case Step::Rate: {
      if (is_raw()) {
        return StepKind::Skip;
      }
      const std::uint8_t width = config_.rate_width != 0 ? config_.rate_width : product_->rate_width;
      return write(into, product_->rate_id, rate_.code, width);
    }
    case Step::Output:
      return is_raw() ? StepKind::Skip : write(into, product_->output_id, product_->output_bits, 4);
    case Step::LostSignal:
      return write(into, product_->lost_signal_id, static_cast<std::uint32_t>(config_.lost_signal_counter),
                   4);
    case Step::Laser:
      return write(into, lwnx_id::kLaser, 1, 1);
    case Step::Stream: {
      const std::uint8_t single =
          config_.mode == LwnxMode::ReadingsMm ? product_->stream_mm : kLwnxStreamReadings;
      return write(into, lwnx_id::kStream, is_raw() ? product_->stream_raw : single, 4);
    }
    default:
      into.patience = std::chrono::seconds(1) + from_seconds(5.0 / rate_hz_);
      return StepKind::AwaitReadings;
  }
}

std::uint8_t LwnxScript::reading_id() const noexcept {
  if (is_raw()) {
    return lwnx_id::kRawReadings;
  }
  return config_.mode == LwnxMode::ReadingsMm ? lwnx_id::kReadingMm : lwnx_id::kReading;
}

std::string_view LwnxScript::meet(std::string_view name, std::uint32_t baud) noexcept {
  product_ = find_lwnx_product(name);
  const std::string_view trouble = product_ == nullptr ? kUnknown : plan(baud);
  if (!trouble.empty()) {
    product_ = nullptr;
  }
  return trouble;
}

/// Settles how the product is used; what stands in the way, if anything.
std::string_view LwnxScript::plan(std::uint32_t baud) noexcept {
  if (!product_->refused.empty()) {
    return product_->refused;
  }
  const bool is_mm = config_.mode == LwnxMode::ReadingsMm;
  if ((is_mm && product_->stream_mm == 0) || (is_raw() && product_->stream_raw == 0)) {
    return kNotThisMode;
  }
  layout_ = {product_->reading_width, product_->reading_unit_m, product_->fields, product_->strength_field};
  if (config_.reading_unit_m > 0.0) {
    layout_.unit_m = config_.reading_unit_m;
  }
  if (is_mm) {
    layout_.width = 4;
    layout_.unit_m = 0.001;
  }
  rate_ = nearest_rate(*product_, config_.rate_hz);
  rate_hz_ = rate_.rate_hz > 0.0 ? rate_.rate_hz : config_.rate_hz;
  double bytes = static_cast<double>(kLwnxOverhead + 1 + layout_.fields * std::size_t{layout_.width});
  if (is_raw()) {
    rate_hz_ = product_->raw_rate_hz;
    bytes = static_cast<double>(kLwnxOverhead + 2) / static_cast<double>(kRawBlock) + 2.0;
  }
  const std::uint32_t used = changes_baud(baud) ? config_.baud : baud;
  return 10.0 * bytes * rate_hz_ > kLineShare * static_cast<double>(used) ? kLineTooSlow : std::string_view{};
}

bool LwnxScript::is_of_rate(std::string_view trouble) noexcept {
  return trouble == kLineTooSlow;
}

LwnxScript::Verdict LwnxScript::judge(const LwnxPacket& packet) noexcept {
  if (product_ == nullptr || packet.id != asked_id_) {
    return Verdict::Foreign;
  }
  const bool wants_token = packet.id == lwnx_id::kToken;
  const auto value = std::span(asked_value_).first(asked_width_);
  const bool is_echo =
      packet.data.size() < value.size() || std::equal(value.begin(), value.end(), packet.data.begin());
  if (!is_echo || (wants_token && packet.data.size() < 2)) {
    return Verdict::Refused;
  }
  if (wants_token) {
    token_ = static_cast<std::uint16_t>(packet.data[0] | packet.data[1] << 8);
  }
  return Verdict::Answered;
}

}  // namespace slamsensor::hal
