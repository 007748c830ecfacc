#include "hal/rangefinder/benewake_config.hpp"
#include "hal/rangefinder/benewake_frame.hpp"
#include "hal/rangefinder/benewake_script.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace slamsensor::hal {
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
    info_.resolution_m = 0.01;
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
