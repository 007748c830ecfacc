#include "firmware/output/nmea_publisher.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::firmware {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr double kRateMin_hz = 0.1;
constexpr double kRateMax_hz = 10.0;
using Cycles = std::chrono::duration<std::int64_t, std::kilo>;
constexpr std::int64_t kCycle_ns = nanoseconds(Cycles(1)).count();  // has as many epochs as the rate has mHz
constexpr nanoseconds kClockStepMin = std::chrono::milliseconds(500);
// gpsd 3.22 takes two epochs of stamps not more than 10 ms apart for one, and then writes JSON that is none.
constexpr std::chrono::duration<std::int64_t, std::centi> kStampGap{2};
constexpr hal::Stamp kPromptGapMax = seconds(1);
constexpr hal::Stamp kPromptRetry = std::chrono::milliseconds(1);

constexpr std::array<std::string_view, 4> kNames = {"nmea_epochs", "nmea_epochs_prompt", "nmea_epochs_missed",
                                                    "clock_steps"};

constexpr hal::Stamp kReportAgeMax = std::chrono::seconds(5);
constexpr hal::Stamp kWaitMax = std::chrono::milliseconds(100);

bool agrees(SensorState state, core::FixStatus status) noexcept {
  switch (status) {
    case core::FixStatus::Fix:
      return state == SensorState::Fixed;
    case core::FixStatus::Ambiguous:
      return state == SensorState::Ambiguous;
    case core::FixStatus::NoFix:
      break;
  }
  return true;
}

std::optional<GeoReference> geo_reference(const std::optional<Datum>& datum) {
  return datum ? std::optional<GeoReference>(std::in_place, *datum) : std::nullopt;
}

/// From the middle of the scan to the epoch, on the clock that nobody sets; empty before the first scan.
std::optional<std::chrono::nanoseconds> scan_age(const core::ScanTime& scan, const PlannedEpoch& epoch,
                                                 const OutputTime& now) noexcept {
  if (scan.end_monotonic == hal::Stamp{}) {
    return std::nullopt;
  }
  const hal::Stamp since_end = now.monotonic - (now.utc - epoch.utc) - scan.end_monotonic;
  return since_end + (scan.end_utc - scan.middle_utc);
}

}  // namespace

void EpochPlanner::set_rate(double rate_hz) noexcept {
  rate_mhz_ = std::llround(std::clamp(rate_hz, kRateMin_hz, kRateMax_hz) * 1000.0);
  if (last_call_) {
    last_index_ = index_at(last_call_->utc);
  }
}

/// Number of the last regular epoch at or before `utc`.
std::int64_t EpochPlanner::index_at(nanoseconds utc) const noexcept {
  const Cycles cycle = std::chrono::floor<Cycles>(utc);
  return cycle.count() * rate_mhz_ + nanoseconds(utc - cycle).count() * rate_mhz_ / kCycle_ns;
}

nanoseconds EpochPlanner::time_of(std::int64_t index) const noexcept {
  const std::int64_t cycle = index / rate_mhz_ - (index % rate_mhz_ < 0 ? 1 : 0);
  const std::int64_t in_cycle = index - cycle * rate_mhz_;
  return Cycles(cycle) + nanoseconds((in_cycle * kCycle_ns + rate_mhz_ - 1) / rate_mhz_);
}

hal::Stamp EpochPlanner::prompt_gap() const noexcept {
  return std::min<hal::Stamp>(kPromptGapMax, time_of(1) - time_of(0));
}

bool EpochPlanner::was_clock_set(const OutputTime& now) const noexcept {
  const nanoseconds ahead = now.utc - last_call_->utc - (now.monotonic - last_call_->monotonic);
  return std::chrono::abs(ahead) >= kClockStepMin;
}

std::optional<PlannedEpoch> EpochPlanner::next(const OutputTime& now, EpochNews news) noexcept {
  const std::int64_t index = index_at(now.utc);
  const bool is_set = last_call_ && was_clock_set(now);
  if (!last_call_ || is_set) {
    last_stamp_.reset();
    last_second_.reset();
    last_index_ = index;
  }
  clock_steps_ += is_set ? 1 : 0;
  last_call_ = now;
  if (index > last_index_) {
    return regular(index);
  }
  return news == EpochNews::Waiting ? prompt(now) : std::nullopt;
}

std::optional<PlannedEpoch> EpochPlanner::regular(std::int64_t index) noexcept {
  const Hundredths stamp = std::chrono::floor<Hundredths>(time_of(index));
  if (last_stamp_ && stamp <= *last_stamp_) {  // after a change of the rate
    last_index_ = index;
    return std::nullopt;
  }
  const seconds second = std::chrono::floor<seconds>(stamp);
  const PlannedEpoch epoch{stamp, EpochKind::Regular, second != last_second_,
                           static_cast<std::uint64_t>(index - last_index_ - 1)};
  last_index_ = index;
  last_stamp_ = stamp;
  last_second_ = second;
  return epoch;
}

std::optional<PlannedEpoch> EpochPlanner::prompt(const OutputTime& now) noexcept {
  if (last_prompt_ && now.monotonic - *last_prompt_ < prompt_gap()) {
    return std::nullopt;
  }
  Hundredths stamp = std::chrono::floor<Hundredths>(now.utc);
  if (last_stamp_ && stamp < *last_stamp_ + kStampGap) {
    stamp = *last_stamp_ + kStampGap;
  }
  // Too near to the next regular epoch the news are left to that one, which comes within 10 ms.
  if (stamp + kStampGap > std::chrono::floor<Hundredths>(time_of(last_index_ + 1))) {
    return std::nullopt;
  }
  last_prompt_ = now.monotonic;
  last_stamp_ = stamp;
  return PlannedEpoch{stamp, EpochKind::Prompt, false, 0};
}

hal::Stamp EpochPlanner::wait(const OutputTime& now, EpochNews news) const noexcept {
  const hal::Stamp period = time_of(1) - time_of(0);
  hal::Stamp wait = std::clamp<hal::Stamp>(time_of(index_at(now.utc) + 1) - now.utc, hal::Stamp{}, period);
  if (news == EpochNews::Waiting) {
    const hal::Stamp prompt = last_prompt_ ? *last_prompt_ + prompt_gap() - now.monotonic : hal::Stamp{};
    wait = std::min(wait, std::max(prompt, kPromptRetry));
  }
  return wait;
}

core::Fix shown_fix(const SensorStatus& status, hal::Stamp now) noexcept {
  core::Fix fix = status.report.fix;
  const bool is_old = now - status.report.monotonic > kReportAgeMax;
  if (fix.status != core::FixStatus::NoFix && (is_old || !agrees(status.state, fix.status))) {
    fix.status = core::FixStatus::NoFix;
    fix.reason = is_old ? core::FixReason::Stale : core::FixReason::Device;
  }
  return fix;
}

NmeaPublisher::NmeaPublisher(const NmeaPublisherConfig& config)
    : config_(config), geo_(geo_reference(config.datum)), planner_(config.rate_hz), counters_(kNames) {
}

void NmeaPublisher::set_config(const NmeaPublisherConfig& config) {
  if (config.rate_hz != config_.rate_hz) {
    planner_.set_rate(config.rate_hz);
  }
  config_ = config;
  geo_ = geo_reference(config.datum);
}

bool NmeaPublisher::add(EpochSink& sink) noexcept {
  if (sink_count_ == sinks_.size()) {
    return false;
  }
  sinks_[sink_count_++] = &sink;
  return true;
}

void NmeaPublisher::take_out(const EpochSink& sink) noexcept {
  EpochSink** const end = sinks_.data() + sink_count_;
  sink_count_ = static_cast<std::size_t>(std::remove(sinks_.data(), end, &sink) - sinks_.data());
}

void NmeaPublisher::step(const OutputTime& now, const SensorStatus& status) noexcept {
  for (EpochSink* const sink : sinks()) {
    sink->step(now.monotonic);
  }
  const core::Fix shown = shown_fix(status, now.monotonic);
  const bool is_new = shown.status != last_status_ || shown.time.end_monotonic != last_scan_;
  news_ = is_new && config_.nmea.prompt ? EpochNews::Waiting : EpochNews::None;
  mode_ = status.report.source == SourceMode::Live ? NmeaMode::Live : NmeaMode::Simulated;
  const std::uint64_t steps = planner_.clock_steps();
  const std::optional<PlannedEpoch> epoch = planner_.next(now, news_);
  counters_.count(NmeaEvent::ClockSteps, planner_.clock_steps() - steps);
  if (epoch) {
    write(shown, *epoch, now);
  }
}

void NmeaPublisher::write(const core::Fix& shown, const PlannedEpoch& epoch, const OutputTime& now) noexcept {
  NmeaContext context = nmea_context(config_.nmea, geo_ ? &*geo_ : nullptr, mode_);
  context.zda = context.zda && epoch.begins_second;
  context.moment = NmeaMoment{epoch.utc, scan_age(shown.time, epoch, now)};
  const std::size_t size = format_nmea(shown, context, bytes_);
  for (EpochSink* const sink : sinks()) {
    sink->send(std::span<const char>(bytes_).first(size), now);
  }
  news_ = EpochNews::None;
  last_status_ = shown.status;
  last_scan_ = shown.time.end_monotonic;
  counters_.count(NmeaEvent::Epochs);
  counters_.count(NmeaEvent::Prompt, epoch.kind == EpochKind::Prompt ? 1 : 0);
  counters_.count(NmeaEvent::Missed, epoch.missed);
}

hal::Stamp NmeaPublisher::wait(const OutputTime& now) const noexcept {
  return std::min(kWaitMax, planner_.wait(now, news_));
}

std::size_t NmeaPublisher::poll_on(std::span<pollfd> into) const noexcept {
  std::size_t count = 0;
  for (const EpochSink* const sink : sinks()) {
    count += sink->poll_on(into.subspan(count));
  }
  return count;
}

void NmeaPublisher::append_counters(CounterTable& table) const noexcept {
  table.append(counters_.all());
  for (const EpochSink* const sink : sinks()) {
    table.append(sink->counters());
  }
}

std::string_view NmeaPublisher::problem() const noexcept {
  for (const EpochSink* const sink : sinks()) {
    if (!sink->problem().empty()) {
      return sink->problem();
    }
  }
  return {};
}

}  // namespace slamsensor::firmware
