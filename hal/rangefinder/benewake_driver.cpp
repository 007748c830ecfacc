#include "hal/rangefinder/benewake_driver.hpp"

#include "hal/rangefinder/benewake_frame.hpp"
#include "hal/rangefinder/dialogue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

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

namespace {

using Step = BenewakeScript::Step;

constexpr std::array<std::uint32_t, 8> kLikelyBauds = {115200, 921600, 1000000, 460800,
                                                       256000, 230400, 57600,   9600};
constexpr double kStrengthUpToHz = 1000.0;  // above, the strength has no meaning (TF03 manual)
constexpr double kLineShare = 0.98;
constexpr std::string_view kLineTooSlow =
    "the device's line rate is too low for the readings asked for; lower the rate or let the driver change "
    "the baud rate";

class BenewakeSerialDriver final : public SerialRangeDriver {
 public:
  BenewakeSerialDriver(const BenewakeSerialConfig& config, ByteLink& link) noexcept
      : SerialRangeDriver(link, rates_from(config.baud, kLikelyBauds), config.device.range),
        config_(config),
        product_(benewake_product(config.device.model)),
        script_(config.device, product_.commands) {
    info_.product = FixedText<32>(product_.name);
  }

 private:
  void begin() noexcept override { expect_rate(config_.device.rate_hz, 1); }
  StepKind compose(unsigned step, Request& into) noexcept override;
  unsigned resume_step() const noexcept override { return static_cast<unsigned>(Step::Rate); }
  void on_byte(std::uint8_t byte, Stamp now) noexcept override;
  void on_pause(Stamp now) noexcept override;
  void on_reading(Stamp now) noexcept;
  void on_reply(Stamp now) noexcept;
  [[nodiscard]] std::uint32_t wanted_baud() const noexcept;
  [[nodiscard]] bool is_line_fast_enough() const noexcept;

  BenewakeSerialConfig config_;
  const BenewakeProduct& product_;
  BenewakeScript script_;
  BenewakeParser parser_{counters_};
  bool baud_was_changed_ = false;
};

std::uint32_t BenewakeSerialDriver::wanted_baud() const noexcept {
  const bool is_other = config_.policy == BenewakeSerialConfig::Baud::Change && !baud_was_changed_ &&
                        serial_.baud() != config_.baud;
  return is_other ? config_.baud : 0;
}

bool BenewakeSerialDriver::is_line_fast_enough() const noexcept {
  return 10.0 * static_cast<double>(kBenewakeFrame) * config_.device.rate_hz <=
         kLineShare * static_cast<double>(serial_.baud());
}

StepKind BenewakeSerialDriver::compose(unsigned step, Request& into) noexcept {
  const StepKind kind = script_.compose(static_cast<Step>(step), wanted_baud(), into);
  if (static_cast<Step>(step) == Step::Reopen && kind == StepKind::Ask) {
    baud_was_changed_ = true;
    serial_.set_baud(config_.baud);
  }
  if (kind == StepKind::Done) {
    baud_was_changed_ = false;
  }
  return kind;
}

void BenewakeSerialDriver::on_byte(std::uint8_t byte, Stamp now) noexcept {
  const BenewakeParser::Found found = parser_.push(byte);
  if (found.has_reply) {
    on_reply(now);
  }
  if (found.has_reading) {
    on_reading(now);
  }
}

/// Where the next frame is due before a pause is one, a pause is a disturbance, and what was cut off by it is
/// not believed until the next frame shows that it was whole.
void BenewakeSerialDriver::on_pause(Stamp now) noexcept {
  if (from_seconds(1.0 / config_.device.rate_hz) >= kPause && parser_.pause().has_reading) {
    on_reading(now);
  }
}

void BenewakeSerialDriver::on_reading(Stamp now) noexcept {
  const Strength strength = config_.device.rate_hz > kStrengthUpToHz ? Strength::Unknown : Strength::Known;
  const Measurement raw = measured(parser_.reading(), product_, config_.device.over_range_cm);
  const std::array block = {judged(raw, strength, config())};
  deliver_record(block, parser_.reading_end() - kBenewakeFrame, parser_.reading_end(), now);
}

void BenewakeSerialDriver::on_reply(Stamp now) noexcept {
  if (dialogue_.state() == DeviceState::Ready) {
    return;  // also data can look like one
  }
  switch (script_.judge(parser_.reply())) {
    case BenewakeScript::Verdict::Answered:
      if (dialogue_.is_asking(static_cast<unsigned>(Step::Version)) && wanted_baud() == 0 &&
          !is_line_fast_enough()) {
        dialogue_.fault_of_rate(now, kLineTooSlow);
        break;
      }
      dialogue_.answered(now);
      break;
    case BenewakeScript::Verdict::Refused:
      counters_.count(RangeEvent::RequestsRefused);
      break;
    case BenewakeScript::Verdict::Foreign:
      counters_.count(RangeEvent::ForeignRecords);
      break;
  }
}

}  // namespace

tl::expected<std::unique_ptr<Rangefinder>, InitError> make_benewake_serial(const BenewakeSerialConfig& config,
                                                                           ByteLink& link) {
  if (auto error = benewake_config_error(config.device)) {
    return tl::unexpected(*error);
  }
  if (config.baud < 9600 || config.baud > 4'000'000) {
    return tl::unexpected(
        InitError{"benewake: baud " + std::to_string(config.baud) + " is outside 9600 to 4000000"});
  }
  BenewakeSerialConfig complete = config;
  complete.device = with_product_limits(config.device);
  return std::unique_ptr<Rangefinder>(std::make_unique<BenewakeSerialDriver>(complete, link));
}

namespace {

using Step = BenewakeScript::Step;

constexpr std::size_t kFramesPerStep = 512;  // 40 ms of a full bus at 1 Mbit/s
constexpr std::uint32_t kFrameBits = 44;     // of a standard frame without data and stuffing
constexpr std::uint32_t kStandardIdMax = 0x7FF;
constexpr std::uint32_t kExtendedIdMax = 0x1FFFFFFF;

/// The CAN bus as far as a start-up uses it.
class CanLine final : public DeviceLine {
 public:
  CanLine(const BenewakeCanConfig& config, CanLink& link) noexcept : config_(config), link_(link) {}

  void service(Stamp now) noexcept override { link_.service(now); }
  [[nodiscard]] bool is_up() const noexcept override { return link_.is_up(); }
  [[nodiscard]] std::string_view problem() const noexcept override { return link_.problem(); }
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return link_.epoch(); }
  void next_rate() noexcept override {}
  void keep_rate() noexcept override {}

  [[nodiscard]] LinkStatus send(std::span<const std::uint8_t> bytes) noexcept override {
    CanFrame frame{.id = config_.host_id, .extended = config_.host_id_is_extended};
    frame.size = static_cast<std::uint8_t>(std::min(bytes.size(), frame.data.size()));
    std::copy_n(bytes.begin(), frame.size, frame.data.begin());
    return link_.send(frame);
  }

 private:
  const BenewakeCanConfig config_;
  CanLink& link_;
};

class BenewakeCanDriver final : public RangeDriver {
 public:
  BenewakeCanDriver(const BenewakeCanConfig& config, CanLink& link) noexcept
      : RangeDriver(std::make_unique<CanLine>(config, link), config.device.range),
        config_(config),
        link_(link),
        product_(benewake_product(config.device.model)),
        script_(config.device, config.commands == BenewakeCanConfig::Commands::None ? BenewakeCommands::None
                                                                                    : product_.commands) {
    info_.product = FixedText<32>(product_.name);
  }

 private:
  void begin() noexcept override { expect_rate(config_.device.rate_hz, 1); }
  StepKind compose(unsigned step, Request& into) noexcept override {
    return script_.compose(static_cast<Step>(step), 0, into);
  }
  unsigned resume_step() const noexcept override { return static_cast<unsigned>(Step::Rate); }
  void receive(Stamp now) noexcept override;
  void on_frame(const CanFrame& frame, Stamp stamp, Stamp now) noexcept;
  [[nodiscard]] bool is_reply(const CanFrame& frame, Stamp now) noexcept;

  BenewakeCanConfig config_;
  CanLink& link_;
  const BenewakeProduct& product_;
  BenewakeScript script_;
};

void BenewakeCanDriver::receive(Stamp now) noexcept {
  for (std::size_t i = 0; i < kFramesPerStep; ++i) {
    const CanRead got = link_.receive();
    if (got.status != LinkStatus::Ok) {
      return;
    }
    if (got.frame.id == config_.device_id && got.frame.extended == config_.device_id_is_extended) {
      on_frame(got.frame, got.stamp, now);
    }
  }
}

void BenewakeCanDriver::on_frame(const CanFrame& frame, Stamp stamp, Stamp now) noexcept {
  if (is_reply(frame, now)) {
    return;
  }
  const auto bytes = frame.bytes();
  const auto reading = read_benewake_can(bytes);
  if (!reading) {
    counters_.count(RangeEvent::LengthsRefused);
    return;
  }
  const std::array block = {
      judged(measured(*reading, product_, config_.device.over_range_cm), Strength::Known, config())};
  const double bits = kFrameBits + 8.0 * static_cast<double>(bytes.size());
  deliver(block, stamp - from_seconds(bits / config_.bitrate), now);
}

/// A frame that answers the request under way; a reading that looks like that is lost, but not misread.
bool BenewakeCanDriver::is_reply(const CanFrame& frame, Stamp now) noexcept {
  if (dialogue_.state() == DeviceState::Ready || config_.commands == BenewakeCanConfig::Commands::None) {
    return false;
  }
  const auto reply = benewake_reply_in(frame.bytes());
  if (reply.empty()) {
    return false;
  }
  switch (script_.judge(reply)) {
    case BenewakeScript::Verdict::Answered:
      dialogue_.answered(now);
      return true;
    case BenewakeScript::Verdict::Refused:
      counters_.count(RangeEvent::RequestsRefused);
      return true;
    case BenewakeScript::Verdict::Foreign:
      break;
  }
  return false;
}

bool is_id(std::uint32_t id, bool is_extended) noexcept {
  return id <= (is_extended ? kExtendedIdMax : kStandardIdMax);
}

}  // namespace

tl::expected<std::unique_ptr<Rangefinder>, InitError> make_benewake_can(const BenewakeCanConfig& config,
                                                                        CanLink& link) {
  if (auto error = benewake_config_error(config.device)) {
    return tl::unexpected(*error);
  }
  if (config.device.rate_hz > 1000.0) {
    return tl::unexpected(InitError{"benewake: rate_hz " + std::to_string(config.device.rate_hz) +
                                    " is more than the 1000 that a CAN bus is asked to carry"});
  }
  if (!is_id(config.device_id, config.device_id_is_extended) ||
      !is_id(config.host_id, config.host_id_is_extended)) {
    return tl::unexpected(
        InitError{"benewake: a CAN id is beyond 0x7FF, or 0x1FFFFFFF when extended: device " +
                  std::to_string(config.device_id) + ", host " + std::to_string(config.host_id)});
  }
  if (config.bitrate < 10'000 || config.bitrate > 1'000'000) {
    return tl::unexpected(
        InitError{"benewake: bitrate " + std::to_string(config.bitrate) + " is outside 10000 to 1000000"});
  }
  BenewakeCanConfig complete = config;
  complete.device = with_product_limits(config.device);
  return std::unique_ptr<Rangefinder>(std::make_unique<BenewakeCanDriver>(complete, link));
}

}  // namespace slamsensor::hal
