#include "tools/emulator/rangefinder/laser_machine.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr std::uint64_t kRecordStream = 101;
constexpr std::uint64_t kAnswerStream = 102;

}  // namespace

MessageQueue::Message& MessageQueue::push() {
  if (count_ == ring_.size()) {
    grow();
  }
  Message& message = ring_[(head_ + count_) % ring_.size()];
  ++count_;
  message.bytes.clear();
  message.measured.clear();
  return message;
}

void MessageQueue::pop() {
  head_ = (head_ + 1) % ring_.size();
  --count_;
}

void MessageQueue::clear() {
  head_ = 0;
  count_ = 0;
}

void MessageQueue::grow() {
  std::vector<Message> wider(2 * ring_.size());
  for (std::size_t i = 0; i < count_; ++i) {
    wider[i] = std::move(ring_[(head_ + i) % ring_.size()]);
  }
  ring_ = std::move(wider);
  head_ = 0;
}

Outbox::Outbox(OutboxLine& line, RangeScene& scene, const OutboxDelays& delays, std::uint64_t seed)
    : line_(line),
      scene_(scene),
      record_delay_(delays.record, mix_seed(seed, kRecordStream)),
      answer_delay_(delays.answer, mix_seed(seed, kAnswerStream)) {
}

void Outbox::put_record(std::span<const std::uint8_t> bytes, std::span<const Stamp> measured, Stamp at) {
  MessageQueue::Message& message = records_.push();
  last_record_ = std::max(last_record_, at + record_delay_.draw());
  message.due = last_record_;
  message.bytes.assign(bytes.begin(), bytes.end());
  message.measured.assign(measured.begin(), measured.end());
}

void Outbox::put_answer(std::span<const std::uint8_t> bytes, Stamp at, std::span<const Stamp> measured) {
  MessageQueue::Message& message = answers_.push();
  last_answer_ = std::max(last_answer_, at + answer_delay_.draw());
  message.due = last_answer_;
  message.bytes.assign(bytes.begin(), bytes.end());
  message.measured.assign(measured.begin(), measured.end());
}

Stamp Outbox::next() const {
  const Stamp record = records_.empty() ? hal::kNever : records_.front().due;
  const Stamp answer = answers_.empty() ? hal::kNever : answers_.front().due;
  return std::min(record, answer);
}

void Outbox::release(Stamp now, Voice voice) {
  while (next() <= now) {
    const bool is_answer =
        !answers_.empty() && (records_.empty() || answers_.front().due <= records_.front().due);
    MessageQueue& queue = is_answer ? answers_ : records_;
    if (voice == Voice::On) {
      send(queue.front(), is_answer ? Urgency::Answer : Urgency::Record);
    }
    queue.pop();
  }
}

void Outbox::send(const MessageQueue::Message& message, Urgency urgency) {
  const std::optional<Stamp> on_wire = line_.put(message.bytes, message.due, urgency);
  if (!on_wire) {
    ++dropped_;
    return;
  }
  sent_ += urgency == Urgency::Record ? 1 : 0;
  for (const Stamp measured : message.measured) {
    scene_.reported(measured, *on_wire);
  }
}

void Outbox::clear() {
  records_.clear();
  answers_.clear();
}

bool FaultWindows::take(FaultKind kind) {
  if (ordered_[index(kind)] == 0) {
    return false;
  }
  --ordered_[index(kind)];
  return true;
}

Sight look(RangeScene& scene, Stamp at, const FaultWindows& faults) {
  const Target target = scene.shoot(at);
  if (faults.is_open(FaultKind::DeviceError, at)) {
    return {.kind = SightKind::Error};
  }
  if (target.kind != TargetKind::Target || faults.is_open(FaultKind::NoReturns, at)) {
    return {};
  }
  Sight sight{SightKind::Target, target.range_m, target.reflectance};
  if (faults.is_open(FaultKind::WeakSignal, at)) {
    sight.kind = SightKind::Weak;
  } else if (faults.is_open(FaultKind::Saturation, at)) {
    sight.kind = SightKind::Saturated;
  }
  return sight;
}

double StrengthModel::of(const Sight& sight) const {
  constexpr double kNearest_m = 0.01;
  const double range_m = std::max(sight.range_m, kNearest_m);
  return std::min(ceiling, at_1m * sight.reflectance / (range_m * range_m));
}

void ShotTimer::start(hal::Stamp at, double rate_hz) {
  period_ns_ = 1e9 / (rate_hz * speed_);
  origin_ = at;
  next_ = at;
  done_ = 0;
}

void ShotTimer::start_after(hal::Stamp now, double rate_hz) {
  start(now, rate_hz);
  advance();
}

void ShotTimer::advance() {
  ++done_;
  next_ = origin_ + hal::Stamp(std::llround(static_cast<double>(done_) * period_ns_));
}

std::optional<Stamp> SerialOutboxLine::put(std::span<const std::uint8_t> bytes, Stamp at, Urgency urgency) {
  const Stamp begin = std::max(at, sink_.busy_until());
  // What is still in the buffer takes until `begin` to leave it.
  const Stamp room_after = begin - at + hal::line_time(bytes.size(), baud_);
  if (urgency == Urgency::Record && begin > at && room_after > hal::line_time(buffer_bytes_, baud_)) {
    return std::nullopt;
  }
  sink_.send(bytes, at);
  return begin;
}

Stamp LaserMachine::next_event() const {
  return power.is_up() ? std::min({timer.next(), outbox.next(), restart_at}) : power.next();
}

bool LaserMachine::takes_shot(Stamp now) {
  if (timer.next() > now) {
    return false;
  }
  timer.advance();
  return true;
}

void LaserMachine::release(Stamp now) {
  outbox.release(now, faults.is_open(FaultKind::Silence, now) ? Outbox::Voice::Silent : Outbox::Voice::On);
}

void LaserMachine::go_down(Stamp until) {
  power.cut(until);
  outbox.clear();
  timer.stop();
  restart_at = hal::kNever;
}

bool LaserMachine::open(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::Silence:
    case FaultKind::NoReturns:
    case FaultKind::WeakSignal:
    case FaultKind::Saturation:
      faults.open(fault);
      return true;
    default:
      return false;
  }
}

}  // namespace slamsensor::tools
