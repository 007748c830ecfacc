#include "hal/rangefinder/lwnx_driver.hpp"

#include "hal/rangefinder/dialogue.hpp"
#include "hal/rangefinder/lwnx_packet.hpp"
#include "hal/rangefinder/lwnx_products.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace slamsensor::hal {

/// The start-up of an LWNX device: find it, know it by its name, then make it send what the configuration
/// asks for with the commands of its row of the table (LW20 serial manual).
class LwnxScript {
 public:
  enum class Step : unsigned {
    Wake,
    Name,
    Quiet,
    Baud,
    BaudToken,
    Save,
    ResetToken,
    Reset,
    Reopen,
    RawMode,
    Rate,
    Output,
    LostSignal,
    Laser,
    Stream,
    Readings,
    Done
  };
  enum class Verdict : std::uint8_t { Answered, Refused, Foreign };

  explicit LwnxScript(const LwnxConfig& config) noexcept : config_(config) {}

  /// What was known of the device is no longer.
  void begin() noexcept { product_ = nullptr; }

  /// See Script::compose. `baud` is the line rate in use; at Step::Reopen the caller has to go to the
  /// configured one.
  [[nodiscard]] StepKind compose(Step step, std::uint32_t baud, Request& into) noexcept;

  /// Takes the device's name and settles how it is used; what stands in the way, if anything, and then the
  /// device counts as not known.
  [[nodiscard]] std::string_view meet(std::string_view name, std::uint32_t baud) noexcept;

  /// Whether what stands in the way is the line rate, not the device.
  [[nodiscard]] static bool is_of_rate(std::string_view trouble) noexcept;

  /// What a packet says of the request under way (but the name).
  [[nodiscard]] Verdict judge(const LwnxPacket& packet) noexcept;

  /// What follows is valid while the device is known.
  [[nodiscard]] bool knows_device() const noexcept { return product_ != nullptr; }
  [[nodiscard]] const LwnxLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] double rate_hz() const noexcept { return rate_hz_; }
  [[nodiscard]] std::size_t readings_per_packet() const noexcept { return is_raw() ? kRawBlock : 1; }
  [[nodiscard]] const LwnxProduct& product() const noexcept { return *product_; }
  /// The command under which readings come.
  [[nodiscard]] std::uint8_t reading_id() const noexcept;
  [[nodiscard]] bool is_raw() const noexcept { return config_.mode == LwnxMode::RawReadings; }

 private:
  static constexpr std::size_t kRawBlock = 200;

  StepKind read(Request& into, std::uint8_t id) noexcept;
  StepKind write(Request& into, std::uint8_t id, std::uint32_t value, std::size_t width) noexcept;
  StepKind compose_baud(Step step, std::uint32_t baud, Request& into) noexcept;
  StepKind compose_settings(Step step, Request& into) noexcept;
  [[nodiscard]] std::string_view plan(std::uint32_t baud) noexcept;
  [[nodiscard]] bool changes_baud(std::uint32_t baud) const noexcept;

  LwnxConfig config_;
  const LwnxProduct* product_ = nullptr;
  LwnxLayout layout_;
  LwnxRate rate_;
  double rate_hz_ = 1.0;
  std::uint8_t asked_id_ = 0;
  std::array<std::uint8_t, 4> asked_value_{};
  std::size_t asked_width_ = 0;  ///< 0: any answer will do
  std::uint16_t token_ = 0;
  bool baud_was_changed_ = false;
};

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
    case Step::Rate:
      return is_raw() ? StepKind::Skip : write(into, product_->rate_id, rate_.code, product_->rate_width);
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

namespace {

using Step = LwnxScript::Step;

constexpr std::array<std::uint32_t, 8> kLikelyBauds = {115200, 921600, 460800, 230400,
                                                       57600,  38400,  19200,  9600};
constexpr std::size_t kNameMax = 16;

class LwnxDriver final : public SerialRangeDriver {
 public:
  LwnxDriver(const LwnxConfig& config, ByteLink& link) noexcept
      : SerialRangeDriver(link, rates_from(config.baud, kLikelyBauds), config.range),
        limits_(config.range),
        wanted_baud_(config.baud),
        script_(config) {}

 private:
  void begin() noexcept override {
    script_.begin();
    clock_.restart();
  }
  StepKind compose(unsigned step, Request& into) noexcept override;
  unsigned resume_step() const noexcept override { return static_cast<unsigned>(Step::Stream); }
  void on_byte(std::uint8_t byte, Stamp now) noexcept override;
  void on_pause(Stamp now) noexcept override;

  void drain(Stamp now) noexcept;
  void on_packet(const LwnxPacket& packet, Stamp now) noexcept;
  void on_name(std::span<const std::uint8_t> data, Stamp now) noexcept;
  void on_reply(const LwnxPacket& packet, Stamp now) noexcept;
  void on_readings(const LwnxPacket& packet, Stamp now) noexcept;

  RangeConfig limits_;  // the product's where none were set
  std::uint32_t wanted_baud_;
  LwnxScript script_;
  LwnxParser parser_{counters_};
};

StepKind LwnxDriver::compose(unsigned step, Request& into) noexcept {
  const StepKind kind = script_.compose(static_cast<Step>(step), serial_.baud(), into);
  if (static_cast<Step>(step) == Step::Reopen && kind == StepKind::Ask) {
    serial_.set_baud(wanted_baud_);
  }
  return kind;
}

void LwnxDriver::on_byte(std::uint8_t byte, Stamp now) noexcept {
  parser_.push(byte);
  drain(now);
}

void LwnxDriver::on_pause(Stamp now) noexcept {
  while (parser_.is_in_packet()) {
    parser_.give_up();
    drain(now);
  }
}

void LwnxDriver::drain(Stamp now) noexcept {
  while (const auto packet = parser_.next()) {
    on_packet(*packet, now);
  }
}

void LwnxDriver::on_packet(const LwnxPacket& packet, Stamp now) noexcept {
  if (script_.knows_device() && packet.id == script_.reading_id()) {
    on_readings(packet, now);
  } else if (packet.id == lwnx_id::kProductName && dialogue_.is_asking(static_cast<unsigned>(Step::Name))) {
    on_name(packet.data, now);
  } else if (dialogue_.state() != DeviceState::Ready) {
    on_reply(packet, now);
  } else {
    counters_.count(RangeEvent::ForeignRecords);
  }
}

void LwnxDriver::on_name(std::span<const std::uint8_t> data, Stamp now) noexcept {
  std::array<char, kNameMax> text{};
  std::size_t size = 0;
  while (size < std::min(data.size(), text.size()) && data[size] != 0) {
    text[size] = static_cast<char>(data[size]);
    ++size;
  }
  const std::string_view name(text.data(), size);
  info_.product = FixedText<32>(name);
  const std::string_view trouble = script_.meet(name, serial_.baud());
  if (!trouble.empty()) {
    if (LwnxScript::is_of_rate(trouble)) {
      dialogue_.fault_of_rate(now, trouble);
    } else {
      dialogue_.fault(now, trouble);
    }
    return;
  }
  limits_ = config();
  limits_.saturated_from =
      std::isinf(limits_.saturated_from) ? script_.product().saturated_from : limits_.saturated_from;
  expect_rate(script_.rate_hz(), script_.readings_per_packet());
  dialogue_.answered(now);
}

void LwnxDriver::on_reply(const LwnxPacket& packet, Stamp now) noexcept {
  switch (script_.judge(packet)) {
    case LwnxScript::Verdict::Answered:
      dialogue_.answered(now);
      break;
    case LwnxScript::Verdict::Refused:
      counters_.count(RangeEvent::RequestsRefused);
      break;
    case LwnxScript::Verdict::Foreign:
      counters_.count(RangeEvent::ForeignRecords);
      break;
  }
}

void LwnxDriver::on_readings(const LwnxPacket& packet, Stamp now) noexcept {
  std::array<Measurement, kBlockMax> block{};
  std::size_t count = 0;
  if (script_.is_raw()) {
    count = read_lwnx_raw(packet.data, block);
  } else if (const auto reading = read_lwnx_reading(packet.data, script_.layout())) {
    block[count++] = *reading;
  }
  if (count == 0) {
    counters_.count(RangeEvent::RecordsRefused);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    block[i] = judged(block[i], script_.is_raw() ? Strength::Unknown : Strength::Known, limits_);
  }
  deliver_record(std::span(block).first(count), packet.begin, packet.end, now);
}

}  // namespace

tl::expected<std::unique_ptr<Rangefinder>, InitError> make_lwnx_rangefinder(const LwnxConfig& config,
                                                                            ByteLink& link) {
  if (auto error = range_config_error(config.range)) {
    return tl::unexpected(*error);
  }
  if (std::find(kLwnxBauds.begin(), kLwnxBauds.end(), config.baud) == kLwnxBauds.end()) {
    return tl::unexpected(InitError{"lightware: baud " + std::to_string(config.baud) +
                                    " is none of 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600"});
  }
  if (!(config.rate_hz >= 0.1 && config.rate_hz <= 20000.0)) {
    return tl::unexpected(
        InitError{"lightware: rate_hz " + std::to_string(config.rate_hz) + " is outside 0.1 to 20000"});
  }
  return std::unique_ptr<Rangefinder>(std::make_unique<LwnxDriver>(config, link));
}

}  // namespace slamsensor::hal
