#pragma once

#include "tools/emulator/delay_draw.hpp"
#include "tools/emulator/emulated_device.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tools {

/// Answers must get through; a record is given up when the line cannot take it.
enum class Urgency : std::uint8_t { Answer, Record };

/// A device's way to the wire.
class OutboxLine {
 public:
  OutboxLine() = default;
  OutboxLine(const OutboxLine&) = delete;
  OutboxLine& operator=(const OutboxLine&) = delete;
  virtual ~OutboxLine() = default;

  /// Sends `bytes` at `at` or as soon as the line is free, and tells when it begins to be sent; nothing when
  /// it was dropped whole.
  virtual std::optional<Stamp> put(std::span<const std::uint8_t> bytes, Stamp at, Urgency urgency) = 0;
};

/// Messages that wait for their time, oldest first. Their memory is used again.
class MessageQueue {
 public:
  struct Message {
    Stamp due{};
    std::vector<std::uint8_t> bytes;
    std::vector<Stamp> measured;
  };

  /// A new last message to be filled in, with empty vectors.
  [[nodiscard]] Message& push();

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] Message& front() { return ring_[head_]; }
  [[nodiscard]] const Message& front() const { return ring_[head_]; }
  void pop();
  void clear();

 private:
  void grow();

  std::vector<Message> ring_ = std::vector<Message>(4);
  std::size_t head_ = 0;
  std::size_t count_ = 0;
};

/// How late a device is: `record` from the last shot of a record to its first bit, `answer` from the end of a
/// command to its answer.
struct OutboxDelays {
  Delay record;
  Delay answer;
};

/// What a rangefinder has to say, each message after its delay. Records stay in their order, and so do
/// answers; an answer may overtake a record. The scene is told of every reading that gets to the wire.
class Outbox {
 public:
  Outbox(OutboxLine& line, RangeScene& scene, const OutboxDelays& delays, std::uint64_t seed);

  /// A record of readings that were measured at `measured` (in order) and finished at `at`.
  void put_record(std::span<const std::uint8_t> bytes, std::span<const Stamp> measured, Stamp at);

  /// An answer to what arrived at `at`; `measured` when it tells readings.
  void put_answer(std::span<const std::uint8_t> bytes, Stamp at, std::span<const Stamp> measured = {});

  /// When release() would send the next message; hal::kNever when none waits.
  [[nodiscard]] Stamp next() const;

  /// Whether an answer waits: it shall leave at the line rate of its command.
  [[nodiscard]] bool has_answers() const { return !answers_.empty(); }

  /// Sends what is due at `now`; to nowhere while the device is held `silent`.
  enum class Voice : std::uint8_t { On, Silent };
  void release(Stamp now, Voice voice);

  /// Forgets what waits.
  void clear();

  /// Records that were sent, and records that the line could not take.
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  void send(const MessageQueue::Message& message, Urgency urgency);

  OutboxLine& line_;
  RangeScene& scene_;
  DelayDraw record_delay_;
  DelayDraw answer_delay_;
  MessageQueue records_;
  MessageQueue answers_;
  Stamp last_record_ = Stamp::min();
  Stamp last_answer_ = Stamp::min();
  std::uint64_t sent_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace slamsensor::tools
