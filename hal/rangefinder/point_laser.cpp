#include "hal/rangefinder/point_laser.hpp"

#include "hal/rangefinder/point_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace slamsensor::hal {
namespace {

InitError wrong(const PointLaserConfig& config, const std::string& what) {
  return InitError{config.product + ": " + what};
}

std::optional<InitError> ascii_error(const PointLaserConfig& config) {
  if (config.terminator.empty() || config.terminator.size() > kPointTerminatorMax) {
    return wrong(config, "terminator must have 1 to " + std::to_string(kPointTerminatorMax) + " characters");
  }
  if (config.width > kPointRecordMax || config.prefix.size() > kPointPrefixMax) {
    return wrong(config, "width " + std::to_string(config.width) + " or the prefix is longer than " +
                             std::to_string(kPointRecordMax) + " or " + std::to_string(kPointPrefixMax));
  }
  if (config.decimals < -1 || config.decimals > 9) {
    return wrong(config, "decimals " + std::to_string(config.decimals) + " is outside -1 (any) to 9");
  }
  return std::nullopt;
}

std::optional<InitError> list_error(const PointLaserConfig& config) {
  if (config.codes.size() > kPointCodesMax || config.texts.size() > kPointCodesMax) {
    return wrong(config, "more than " + std::to_string(kPointCodesMax) + " codes or texts");
  }
  for (const PointText& text : config.texts) {
    if (text.text.empty() || text.text.size() > kPointTextMax) {
      return wrong(config, "text \"" + text.text + "\" must have 1 to " + std::to_string(kPointTextMax) +
                               " characters");
    }
  }
  if (config.set_up.size() > kPointCommandsMax) {
    return wrong(config, "more than " + std::to_string(kPointCommandsMax) + " set_up commands");
  }
  std::size_t longest = std::max(config.start.size(), config.stop.size());
  for (const std::string& command : config.set_up) {
    longest = std::max(longest, command.size());
  }
  if (longest > Request::kBytesMax) {
    return wrong(config, "a command is longer than " + std::to_string(Request::kBytesMax) + " bytes");
  }
  return std::nullopt;
}

}  // namespace

PointLaserConfig astech_lds70a() {
  PointLaserConfig config;
  config.product = "ASTECH LDS70A";
  config.range.range_max_m = 290.0;
  config.texts = {{"DE02", Echo::None}, {"DE04", Echo::Fault}, {"DE06", Echo::Fault}, {"DE10", Echo::Fault}};
  // 11 bytes a reading with CR LF; whether a letter stands before the number is not shown.
  config.width = 9;
  config.prefix = "D";
  config.prefix_is = PointLaserConfig::Prefix::Optional;
  config.stop = "\x1B";
  config.set_up = {"SD 0 0\r"};
  config.start = "DT\r";
  return config;
}

PointLaserConfig mdl_laserace_im_hr_unverified() {
  PointLaserConfig config;
  config.product = "MDL LaserAce IM HR (unverified)";
  config.layout = PointLaserConfig::Layout::Unverified;
  config.range.range_max_m = 300.0;
  return config;
}

std::optional<InitError> point_laser_config_error(const PointLaserConfig& config) {
  if (!(config.rate_hz >= 0.1 && config.rate_hz <= 50000.0)) {
    return wrong(config, "rate_hz " + std::to_string(config.rate_hz) + " is outside 0.1 to 50000");
  }
  if (config.baud < 300 || config.baud > 4'000'000) {
    return wrong(config, "baud " + std::to_string(config.baud) + " is outside 300 to 4000000");
  }
  if (!(config.unit_m > 0.0 && config.unit_m <= 1000.0) || !std::isfinite(config.offset_m)) {
    return wrong(config, "unit_m " + std::to_string(config.unit_m) + " is outside 0 (excluded) to 1000");
  }
  if (config.packed_bytes != 2 && config.packed_bytes != 3) {
    return wrong(config, "packed_bytes " + std::to_string(config.packed_bytes) + " is neither 2 nor 3");
  }
  if (config.settle < Stamp{} || config.settle > std::chrono::seconds(10)) {
    return wrong(config, "settle is outside 0 to 10 s");
  }
  if (auto error = ascii_error(config)) {
    return error;
  }
  if (auto error = list_error(config)) {
    return error;
  }
  return range_config_error(config.range);
}

namespace {

constexpr std::array<std::uint32_t, 8> kLikelyBauds = {115200, 921600, 460800, 230400,
                                                       57600,  38400,  19200,  9600};
constexpr unsigned kStop = 0;
constexpr unsigned kFirstSetUp = 1;
constexpr unsigned kStart = kFirstSetUp + kPointCommandsMax;
constexpr unsigned kReadings = kStart + 1;
constexpr std::string_view kNoRecords =
    "no records of the configured layout; check cable, power, line rate and layout";
constexpr std::string_view kNoRecordsUnverified =
    "no records of the configured layout, which is UNVERIFIED for this device; set it from the device's "
    "manual";

struct Command {
  std::array<std::uint8_t, Request::kBytesMax> bytes{};
  std::size_t size = 0;

  void set(const std::string& text) {
    size = std::min(text.size(), bytes.size());
    std::copy_n(text.begin(), size, bytes.begin());
  }
};

LineRates line_rates(const PointLaserConfig& config) noexcept {
  using Search = PointLaserConfig::Search;
  return config.search == Search::ThisBaud ? LineRates{config.baud} : rates_from(config.baud, kLikelyBauds);
}

class PointLaserDriver final : public SerialRangeDriver {
 public:
  PointLaserDriver(const PointLaserConfig& config, ByteLink& link)
      : SerialRangeDriver(link, line_rates(config), config.range),
        rate_hz_(config.rate_hz),
        settle_(config.settle),
        problem_(config.layout == PointLaserConfig::Layout::Unverified ? kNoRecordsUnverified : kNoRecords),
        records_(make_point_records(config, counters_)) {
    commands_[kStop].set(config.stop);
    commands_[kStart].set(config.start);
    for (std::size_t i = 0; i < std::min(config.set_up.size(), kPointCommandsMax); ++i) {
      commands_[kFirstSetUp + i].set(config.set_up[i]);
    }
    info_.product = FixedText<32>(config.product);
  }

 private:
  void begin() noexcept override {
    records_->interrupt();
    expect_rate(rate_hz_, 1);
  }

  StepKind compose(unsigned step, Request& into) noexcept override {
    if (step > kReadings) {
      return StepKind::Done;
    }
    if (step == kReadings) {
      into.patience = std::chrono::seconds(1) + from_seconds(10.0 / rate_hz_);
      into.if_silent = IfSilent::NextRate;
      into.problem = problem_;
      return StepKind::AwaitReadings;
    }
    if (commands_[step].size == 0) {
      return StepKind::Skip;
    }
    into.say({commands_[step].bytes.data(), commands_[step].size});
    // The device need not answer: the records that follow show whether it understood.
    into.patience = settle_;
    into.tries = 1;
    into.if_silent = IfSilent::GoOn;
    return StepKind::Ask;
  }

  unsigned resume_step() const noexcept override { return kStart; }

  void on_byte(std::uint8_t byte, Stamp now) noexcept override {
    if (records_->push(byte)) {
      const std::array block = {records_->reading()};
      deliver_record(block, records_->begin(), records_->end(), now);
    }
  }

  void on_pause(Stamp) noexcept override { records_->interrupt(); }

  double rate_hz_;
  Stamp settle_;
  std::string_view problem_;
  std::array<Command, kReadings> commands_{};
  std::unique_ptr<PointRecords> records_;
};

}  // namespace

tl::expected<std::unique_ptr<Rangefinder>, InitError> make_point_laser(const PointLaserConfig& config,
                                                                       ByteLink& link) {
  if (auto error = point_laser_config_error(config)) {
    return tl::unexpected(*error);
  }
  return std::unique_ptr<Rangefinder>(std::make_unique<PointLaserDriver>(config, link));
}

}  // namespace slamsensor::hal
