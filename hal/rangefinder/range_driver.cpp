#include "hal/rangefinder/range_driver.hpp"

#include "hal/text_writer.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace slamsensor::hal {

LineRates rates_from(std::uint32_t first, std::span<const std::uint32_t> others) noexcept {
  LineRates rates{first};
  std::size_t count = 1;
  for (const std::uint32_t rate : others) {
    if (rate != first && count < rates.size()) {
      rates[count++] = rate;
    }
  }
  return rates;
}

SerialDeviceLine::SerialDeviceLine(ByteLink& link, const LineRates& rates) noexcept
    : link_(link), rates_(rates) {
}

void SerialDeviceLine::service(Stamp now) noexcept {
  link_.service(now);
  if (link_.baud() != baud()) {
    apply_rate();
    if (link_.is_up() && link_.baud() != baud()) {
      next_rate();  // this adapter cannot run at it
    }
  }
}

void SerialDeviceLine::next_rate() noexcept {
  if (kept_ && rate_ != *kept_) {
    other_ = rate_;
    rate_ = *kept_;
  } else {
    rate_ = after(kept_ ? other_ : rate_);
    if (kept_ && rate_ == *kept_) {
      rate_ = after(rate_);
    }
  }
  apply_rate();
}

std::size_t SerialDeviceLine::after(std::size_t rate) const noexcept {
  const std::size_t next = (rate + 1) % rates_.size();
  return rates_[next] == 0 ? 0 : next;
}

void SerialDeviceLine::set_baud(std::uint32_t baud) noexcept {
  const auto known = std::find(rates_.begin(), rates_.end(), baud);
  if (known != rates_.end()) {
    rate_ = static_cast<std::size_t>(known - rates_.begin());
  } else {
    rate_ = rates_.size() - 1;
    rates_[rate_] = baud;
  }
  apply_rate();
}

void SerialDeviceLine::apply_rate() noexcept {
  // Down: the link uses the rate when it comes back, or cannot and no reply will say so.
  (void)link_.set_baud(baud());
  link_.discard_input();
}

std::span<const std::uint8_t> SerialDeviceLine::read() noexcept {
  if (read_in_step_ >= kBytesPerStep) {
    return {};
  }
  const ByteRead got = link_.read(chunk_);
  if (got.status != LinkStatus::Ok) {
    return {};
  }
  const std::size_t count = std::min(got.count, chunk_.size());
  read_in_step_ += count;
  log_.note(count, got.stamp);
  return {chunk_.data(), count};
}

namespace {

constexpr double kSilentPeriods = 20.0;
constexpr Stamp kSilenceLeast = std::chrono::milliseconds(250);  // longer than a stall of the host
constexpr std::size_t kLostMost = 1000;
constexpr std::uint64_t kUnframedBytes = 200;  // a reply torn by a change of the line rate is shorter
constexpr std::uint64_t kUnframedTold = 10;    // times: smaller changes are not reported
constexpr double kRateReported = 0.01;         // share: smaller changes of a wrong rate are not reported

}  // namespace

std::optional<InitError> range_config_error(const RangeConfig& config) {
  if (!(config.range_max_m > 0.0 && config.range_max_m <= 1e5)) {
    return InitError{"rangefinder: range_max_m " + std::to_string(config.range_max_m) +
                     " is outside 0 (excluded) to 100000"};
  }
  if (!(config.weak_below < config.saturated_from)) {
    return InitError{"rangefinder: weak_below " + std::to_string(config.weak_below) +
                     " is not less than saturated_from " + std::to_string(config.saturated_from)};
  }
  if (!(config.clock.tolerance_ppm >= 0.0 && config.clock.tolerance_ppm <= 1e5)) {
    return InitError{"rangefinder: tolerance_ppm " + std::to_string(config.clock.tolerance_ppm) +
                     " is outside 0 to 100000"};
  }
  return std::nullopt;
}

Measurement judged(Measurement raw, Strength strength, const RangeConfig& config) noexcept {
  raw.told_m = std::isfinite(raw.range_m) ? raw.range_m : 0.0;
  if (raw.echo == Echo::Return) {
    if (!std::isfinite(raw.range_m)) {
      raw.echo = Echo::Fault;
    } else if (raw.range_m <= 0.0 || raw.range_m > config.range_max_m) {
      raw.echo = Echo::None;
    } else if (strength == Strength::Known && raw.strength < config.weak_below) {
      raw.echo = Echo::Weak;
    } else if (strength == Strength::Known && raw.strength >= config.saturated_from) {
      raw.echo = Echo::Saturated;
    }
  }
  if (raw.echo != Echo::Return) {
    raw.range_m = 0.0;
  }
  if (strength == Strength::Unknown) {
    raw.strength = 0.0;
  }
  return raw;
}

RangeDriver::RangeDriver(std::unique_ptr<DeviceLine> line, const RangeConfig& config) noexcept
    : clock_(config.clock), line_(std::move(line)), dialogue_(*line_, *this, counters_), config_(config) {
  info_.range_max_m = config.range_max_m;
}

void RangeDriver::step(Stamp now) noexcept {
  if (!dialogue_.open(now)) {
    clock_.restart();
    doubt_ = {};
    was_in_doubt_ = false;
    return;
  }
  receive(now);
  dialogue_.close(now);
  tell_doubt();
  tell_unframed();
}

std::string_view RangeDriver::problem() const noexcept {
  const bool is_waiting = state() == DeviceState::Starting || state() == DeviceState::Faulted;
  return is_waiting && !unframed_.view().empty() ? unframed_.view() : dialogue_.problem();
}

/// Bytes without any reading among them are another device, another rate of the line, or a bad line.
void RangeDriver::tell_unframed() noexcept {
  const std::uint64_t bytes = counters_[RangeEvent::BytesSkipped] - skipped_before_;
  if (dialogue_.state() == DeviceState::Ready || bytes < kUnframedBytes ||
      bytes < kUnframedTold * told_unframed_) {
    return;
  }
  told_unframed_ = bytes;
  TextWriter<kRemarkMax> text;
  text.whole(static_cast<double>(bytes)) << " bytes and no valid frame";
  if (const auto sums = counters_[RangeEvent::ChecksumErrors] - checksums_before_; sums > 0) {
    text << " (";
    text.whole(static_cast<double>(sums)) << " wrong checksums)";
  }
  text << ": check model and baud rate, then the cable";
  unframed_ = text.text();
}

void RangeDriver::forget_unframed() noexcept {
  skipped_before_ = counters_[RangeEvent::BytesSkipped];
  checksums_before_ = counters_[RangeEvent::ChecksumErrors];
  told_unframed_ = 0;
  unframed_ = {};
}

void RangeDriver::tell_doubt() noexcept {
  const bool is_in_doubt = dialogue_.state() == DeviceState::Ready && clock_.is_in_doubt();
  counters_.count(RangeEvent::TimingDoubts, is_in_doubt && !was_in_doubt_ ? 1 : 0);
  if (!is_in_doubt) {
    was_in_doubt_ = false;
    doubt_ = {};
    return;
  }
  const double rate_hz = clock_.apparent_rate_hz();
  if (was_in_doubt_ && std::abs(rate_hz - reported_hz_) < kRateReported * info_.rate_hz) {
    return;  // a text that changes all the time is no help
  }
  was_in_doubt_ = true;
  reported_hz_ = rate_hz;
  if (std::abs(rate_hz / info_.rate_hz - 1.0) <= config_.clock.tolerance_ppm * 1e-6) {
    doubt_ =
        FixedText<kDoubtMax>("readings come too irregularly to be timed; check cable and load of the host");
    return;
  }
  TextWriter<kDoubtMax> text;
  text << "readings come at ";
  text.whole(rate_hz) << " Hz instead of ";
  text.whole(info_.rate_hz) << " Hz: not used; check rate and cable";
  doubt_ = text.text();
}

void RangeDriver::expect_rate(double rate_hz, std::size_t block) noexcept {
  clock_.set_rate(rate_hz);
  info_.rate_hz = rate_hz;
  const Stamp silence = from_seconds(kSilentPeriods * static_cast<double>(block) / rate_hz);
  dialogue_.expect(rate_hz, std::max(silence, kSilenceLeast));
}

void RangeDriver::deliver(std::span<const Measurement> block, Stamp latest, Stamp now) noexcept {
  block = block.first(std::min(block.size(), kBlockMax));
  std::array<Stamp, kBlockMax> stamps{};
  const std::uint64_t missing = clock_.missing();
  const std::uint64_t relocks = clock_.relocks();
  clock_.stamp(latest, std::span(stamps).first(block.size()));
  counters_.count(RangeEvent::PeriodsMissing, clock_.missing() - missing);
  counters_.count(RangeEvent::PhaseLocks, clock_.relocks() - relocks);
  const bool is_trusted = dialogue_.state() == DeviceState::Ready && clock_.settled();
  dialogue_.heard(now, block.size());
  forget_unframed();
  if (!is_trusted) {
    counters_.count(RangeEvent::ReadingsWithheld, block.size());
    return;
  }
  for (std::size_t i = 0; i < block.size(); ++i) {
    if (!samples_.try_push(
            {stamps[i], block[i].range_m, block[i].strength, block[i].echo, block[i].told_m})) {
      counters_.count(RangeEvent::ReadingsDropped);
    }
  }
}

SerialRangeDriver::SerialRangeDriver(ByteLink& link, const LineRates& rates,
                                     const RangeConfig& config) noexcept
    : RangeDriver(std::make_unique<SerialDeviceLine>(link, rates), config),
      serial_(static_cast<SerialDeviceLine&>(*line_)) {
}

void SerialRangeDriver::receive(Stamp now) noexcept {
  serial_.allow_bytes();
  for (auto bytes = serial_.read(); !bytes.empty(); bytes = serial_.read()) {
    last_byte_ = now;
    for (const std::uint8_t byte : bytes) {
      on_byte(byte, now);
    }
  }
  if (now - last_byte_ > kPause) {
    last_byte_ = now;
    on_pause(now);
  }
}

void SerialRangeDriver::deliver_record(std::span<const Measurement> block, std::uint64_t begin,
                                       std::uint64_t end, Stamp now) noexcept {
  // Bytes between two records are the remains of records that did not come through.
  const std::uint64_t size = end - begin;
  if (clock_.settled() && begin > last_end_ && size > 0) {
    const std::uint64_t lost = (begin - last_end_ + size / 2) / size;
    clock_.skip(static_cast<std::size_t>(std::min<std::uint64_t>(lost, kLostMost)) * block.size());
  }
  last_end_ = end;
  deliver(block, serial_.latest_begin(begin, end), now);
}

}  // namespace slamsensor::hal
