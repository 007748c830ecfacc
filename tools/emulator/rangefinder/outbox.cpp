#include "tools/emulator/rangefinder/outbox.hpp"

#include <algorithm>
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

}  // namespace slamsensor::tools
