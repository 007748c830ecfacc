#pragma once

#include "hal/stamp.hpp"
#include "tools/emulator/emulated_device.hpp"

#include <array>
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

  /// Sends `bytes` at `at` or as soon as the line is free, and returns when it begins to be sent; nothing
  /// when it was dropped whole.
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
/// answers; an answer may overtake a record. The scene gets every reading that gets to the wire.
class Outbox {
 public:
  Outbox(OutboxLine& line, RangeScene& scene, const OutboxDelays& delays, std::uint64_t seed);

  /// A record of readings that were measured at `measured` (in order) and finished at `at`.
  void put_record(std::span<const std::uint8_t> bytes, std::span<const Stamp> measured, Stamp at);

  /// An answer to what arrived at `at`; `measured` when it holds readings.
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

/// The faults that last for a while or wait for the next record.
class FaultWindows {
 public:
  FaultWindows() { until_.fill(Stamp::min()); }

  /// `fault` lasts from now to the end of its duration.
  void open(const Fault& fault) { until_[index(fault.kind)] = fault.at + fault.duration; }

  [[nodiscard]] bool is_open(FaultKind kind, Stamp now) const { return now < until_[index(kind)]; }

  /// The next record shall have this fault.
  void order(FaultKind kind) { ++ordered_[index(kind)]; }

  /// Whether a record now has the fault; an order is used up by it.
  [[nodiscard]] bool take(FaultKind kind);

 private:
  [[nodiscard]] static std::size_t index(FaultKind kind) { return static_cast<std::size_t>(kind); }

  std::array<Stamp, kFaultKinds> until_{};
  std::array<std::uint32_t, kFaultKinds> ordered_{};
};

/// What came back of a shot.
enum class SightKind : std::uint8_t { Nothing, Target, Weak, Saturated, Error };

struct Sight {
  SightKind kind = SightKind::Nothing;
  double range_m = 0.0;      ///< of Target, Weak and Saturated: where the thing is
  double reflectance = 0.0;  ///< of the same

  [[nodiscard]] bool has_echo() const { return kind != SightKind::Nothing && kind != SightKind::Error; }
};

/// One shot at `at`, as the faults of that moment make it look.
[[nodiscard]] Sight look(RangeScene& scene, Stamp at, const FaultWindows& faults);

/// Echo strength by the law of diffuse reflection: falls with the square of the range, up to a ceiling.
struct StrengthModel {
  double at_1m = 0.0;    ///< of a white target one metre away, were there no ceiling
  double ceiling = 0.0;  ///< most that the device reports

  [[nodiscard]] double of(const Sight& sight) const;
};

/// The measuring clock of a rangefinder: shot k is at start + k periods, rounded to the nanosecond, so that
/// no error adds up. The period is that of a crystal that may be off by some parts per million.
class ShotTimer {
 public:
  /// Stopped. `crystal_ppm` > 0: the crystal is fast, shots come earlier than they should.
  explicit ShotTimer(double crystal_ppm) : speed_(1.0 + crystal_ppm * 1e-6) {}

  /// The first shot is at `at`, the others follow at `rate_hz` (positive).
  void start(hal::Stamp at, double rate_hz);

  /// The first shot is one period after `now`.
  void start_after(hal::Stamp now, double rate_hz);

  void stop() { next_ = hal::kNever; }

  [[nodiscard]] bool running() const { return next_ != hal::kNever; }

  /// When the next shot is due; hal::kNever while stopped.
  [[nodiscard]] hal::Stamp next() const { return next_; }

  /// The shot at next() is done; next() is a period later.
  void advance();

 private:
  double speed_;
  double period_ns_ = 0.0;
  hal::Stamp origin_{};
  hal::Stamp next_ = hal::kNever;
  std::int64_t done_ = 0;
};

/// A serial line behind a transmit buffer: a record that does not fit into what is free of the buffer is
/// dropped whole, as devices do whose line is too slow for their rate.
class SerialOutboxLine final : public OutboxLine {
 public:
  SerialOutboxLine(ByteSink& sink, std::uint32_t buffer_bytes) : sink_(sink), buffer_bytes_(buffer_bytes) {}

  /// The line rate for what follows, bit/s.
  void set_baud(std::uint32_t baud) { baud_ = baud; }
  [[nodiscard]] std::uint32_t baud() const { return baud_; }

  /// What is in the buffer is lost.
  void clear() { sink_.clear(); }

  std::optional<Stamp> put(std::span<const std::uint8_t> bytes, Stamp at, Urgency urgency) override;

 private:
  ByteSink& sink_;
  std::uint32_t buffer_bytes_;
  std::uint32_t baud_ = 115200;
};

/// What is the same in every emulated rangefinder: power, the clock of its shots, what waits for its line,
/// the faults under way, a restart to come.
struct LaserMachine {
  /// `settings` are those of any rangefinder; `line` and `scene` outlive this.
  template <typename Settings>
  LaserMachine(const Settings& settings, OutboxLine& line, RangeScene& scene)
      : outbox(line, scene, settings.delays, settings.seed),
        power(settings.begin, settings.boot_time),
        timer(settings.crystal_ppm) {}

  [[nodiscard]] Stamp next_event() const;

  /// Whether a shot is due at `now`; the next one is then a period later.
  [[nodiscard]] bool takes_shot(Stamp now);

  /// What is due goes out, unless a fault keeps it silent.
  void release(Stamp now);

  /// Without power before `until`: nothing waits any more, nothing is shot.
  void go_down(Stamp until);

  /// Takes a fault of what is seen, or of the voice; false for others.
  bool open(const Fault& fault);

  Outbox outbox;
  FaultWindows faults;
  PowerSwitch power;
  ShotTimer timer;
  Stamp restart_at = hal::kNever;
};

}  // namespace slamsensor::tools
