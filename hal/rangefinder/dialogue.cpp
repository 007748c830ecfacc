#include "hal/rangefinder/dialogue.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr std::size_t kReadingsToTrust = 2;
constexpr unsigned kStepsMax = 64;
constexpr Stamp kBackOffFirst = std::chrono::milliseconds(500);
constexpr Stamp kBackOffMost = std::chrono::seconds(8);
constexpr Stamp kTrouble = std::chrono::seconds(5);  // running for so long, the last trouble is forgotten
constexpr Stamp kStopped = std::chrono::milliseconds(500);  // between two steps
constexpr std::string_view kLinkDown = "the link is down; waiting for it to come back";
constexpr std::string_view kStarting = "starting: asking the device what it is";
constexpr std::string_view kNoReadings = "the device answers but sends no readings";
constexpr std::string_view kSilence = "its readings have stopped; check its power and cable";
constexpr std::string_view kOtherRate =
    "readings come at another rate than was set; another program or a restart may have changed it";

}  // namespace

void Request::say(std::span<const std::uint8_t> from) noexcept {
  size = std::min(from.size(), bytes.size());
  std::copy_n(from.begin(), size, bytes.begin());
}

bool Dialogue::open(Stamp now) noexcept {
  line_.service(now);
  if (stepped_ > Stamp{} && now - stepped_ > kStopped) {
    // Nobody listened: what the stream did meanwhile is not the device's doing.
    last_heard_ = now;
    due_ = std::max(due_, now + request_.patience);
    open_window(now);
  }
  stepped_ = now;
  if (!line_.is_up()) {
    if (phase_ != Phase::Absent) {
      counters_.count(RangeEvent::LinkLosses);
      phase_ = Phase::Absent;
    }
    return false;
  }
  if (phase_ == Phase::Absent || epoch_ != line_.epoch()) {
    epoch_ = line_.epoch();
    back_off_ = Stamp{};
    faulted_ = false;
    is_rate_at_fault_ = false;
    problem_ = kStarting;
    start(now);
  }
  return true;
}

void Dialogue::close(Stamp now) noexcept {
  switch (phase_) {
    case Phase::Absent:
      break;
    case Phase::Resting:
      if (now >= due_) {
        start(now);
        ask(now);
      }
      break;
    case Phase::Asking:
      ask(now);
      break;
    case Phase::Awaiting:
      if (now >= due_) {
        problem_ = kNoReadings;
        give_up(now);
      }
      break;
    case Phase::Running:
      watch(now);
      break;
  }
}

void Dialogue::start(Stamp now) noexcept {
  script_.begin();
  go_to(0, now);
}

void Dialogue::go_to(unsigned step, Stamp now) noexcept {
  for (step_ = step; step_ < kStepsMax; ++step_) {
    request_ = {};
    sent_ = 0;
    heard_ = 0;
    switch (script_.compose(step_, request_)) {
      case StepKind::Ask:
        phase_ = Phase::Asking;
        return;
      case StepKind::AwaitReadings:
        phase_ = Phase::Awaiting;
        due_ = now + request_.patience;
        return;
      case StepKind::Skip:
        break;
      case StepKind::Done:
        run(now);
        return;
    }
  }
  run(now);
}

void Dialogue::ask(Stamp now) noexcept {
  if (sent_ > 0 && now < due_) {
    return;
  }
  if (sent_ >= request_.tries) {
    give_up(now);
    return;
  }
  if (request_.size > 0) {
    if (line_.send({request_.bytes.data(), request_.size}) != LinkStatus::Ok) {
      return;  // no room on the line: the next step tries again
    }
    if (sent_ > 0) {
      counters_.count(RangeEvent::RequestsRepeated);
    }
  }
  ++sent_;
  due_ = now + request_.patience;
}

void Dialogue::give_up(Stamp now) noexcept {
  if (!request_.problem.empty() && !is_rate_at_fault_) {
    problem_ = request_.problem;
  }
  switch (request_.if_silent) {
    case IfSilent::GoOn:
      go_to(step_ + 1, now);
      break;
    case IfSilent::NextRate:
      counters_.count(RangeEvent::LineRatesTried);
      line_.next_rate();
      faulted_ = is_rate_at_fault_;
      start(now);
      break;
    case IfSilent::StartOver:
      faulted_ = false;
      rest(now);
      break;
  }
}

void Dialogue::rest(Stamp now) noexcept {
  counters_.count(RangeEvent::StartsOver);
  phase_ = Phase::Resting;
  due_ = now + back_off_;
  back_off_ = std::clamp(2 * back_off_, kBackOffFirst, kBackOffMost);
}

void Dialogue::answered(Stamp now) noexcept {
  if (phase_ == Phase::Asking) {
    go_to(step_ + 1, now);
  }
}

void Dialogue::fault(Stamp now, std::string_view problem) noexcept {
  faulted_ = true;
  is_rate_at_fault_ = false;
  problem_ = problem;
  back_off_ = std::max(back_off_, kBackOffFirst);
  rest(now);
}

void Dialogue::fault_of_rate(Stamp now, std::string_view problem) noexcept {
  fault(now, problem);
  is_rate_at_fault_ = true;
  counters_.count(RangeEvent::LineRatesTried);
  line_.next_rate();
}

void Dialogue::run(Stamp now) noexcept {
  phase_ = Phase::Running;
  line_.keep_rate();
  faulted_ = false;
  is_rate_at_fault_ = false;
  last_heard_ = now;
  running_since_ = now;
  open_window(now);
}

void Dialogue::open_window(Stamp now) noexcept {
  window_begun_ = now;
  heard_ = 0;
}

void Dialogue::heard(Stamp now, std::size_t count) noexcept {
  last_heard_ = now;
  heard_ += count;
  if (phase_ == Phase::Awaiting && heard_ >= kReadingsToTrust) {
    go_to(step_ + 1, now);
  }
}

void Dialogue::expect(double rate_hz, Stamp silence) noexcept {
  rate_hz_ = rate_hz;
  silence_ = silence;
}

void Dialogue::watch(Stamp now) noexcept {
  if (now - last_heard_ > silence_) {
    counters_.count(RangeEvent::StreamSilences);
    problem_ = kSilence;
    go_to(script_.resume_step(), now);
    return;
  }
  if (now - running_since_ > kTrouble) {
    back_off_ = Stamp{};
  }
  // A restart that was too short for a silence shows in the rate, which went back to the device's own.
  const Stamp window = std::max(Stamp(std::chrono::seconds(1)), 4 * silence_);
  if (now - window_begun_ < window) {
    return;
  }
  const double rate_hz = static_cast<double>(heard_) / to_seconds(now - window_begun_);
  if (rate_hz < 0.5 * rate_hz_ || rate_hz > 2.0 * rate_hz_) {
    counters_.count(RangeEvent::RateDeviations);
    faulted_ = back_off_ > Stamp{};
    problem_ = kOtherRate;
    rest(now);
    return;
  }
  open_window(now);
}

DeviceState Dialogue::state() const noexcept {
  if (phase_ == Phase::Absent) {
    return DeviceState::Absent;
  }
  if (phase_ == Phase::Running) {
    return DeviceState::Ready;
  }
  return faulted_ ? DeviceState::Faulted : DeviceState::Starting;
}

std::string_view Dialogue::problem() const noexcept {
  if (phase_ == Phase::Running) {
    return {};
  }
  if (phase_ == Phase::Absent) {
    return line_.problem().empty() ? kLinkDown : line_.problem();
  }
  return problem_;
}

}  // namespace slamsensor::hal
