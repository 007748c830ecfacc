#include "hal/rangefinder/point_laser.hpp"
#include "hal/rangefinder/point_record.hpp"

#include <algorithm>
#include <array>

namespace slamsensor::hal {
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
    info_.resolution_m = config.resolution_m;
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
    // The device need not answer: the records that follow tell whether it understood.
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
