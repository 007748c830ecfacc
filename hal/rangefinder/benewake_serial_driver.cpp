#include "hal/rangefinder/benewake_config.hpp"
#include "hal/rangefinder/benewake_frame.hpp"
#include "hal/rangefinder/benewake_script.hpp"

#include <array>
#include <string>

namespace slamsensor::hal {
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
    info_.resolution_m = 0.01;
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

}  // namespace slamsensor::hal
