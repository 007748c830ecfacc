#include "hal/rangefinder/lwnx_driver.hpp"

#include "hal/rangefinder/lwnx_reading.hpp"
#include "hal/rangefinder/lwnx_script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace slamsensor::hal {
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
  info_.resolution_m = script_.is_raw() ? 0.01 : script_.layout().unit_m;
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
  if (config.rate_width != 0 && config.rate_width != 1 && config.rate_width != 2 && config.rate_width != 4) {
    return tl::unexpected(InitError{"lightware: rate_width " + std::to_string(config.rate_width) +
                                    " is none of 0 (by product), 1, 2, 4"});
  }
  if (!(config.reading_unit_m >= 0.0 && config.reading_unit_m <= 1.0)) {
    return tl::unexpected(InitError{"lightware: reading_unit_m " + std::to_string(config.reading_unit_m) +
                                    " is outside 0 (by product) to 1"});
  }
  return std::unique_ptr<Rangefinder>(std::make_unique<LwnxDriver>(config, link));
}

}  // namespace slamsensor::hal
