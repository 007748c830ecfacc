#pragma once

#include "hal/fixed_text.hpp"
#include "hal/pantilt/ptu_command.hpp"
#include "hal/pantilt/ptu_config.hpp"
#include "hal/pantilt/ptu_reply.hpp"
#include "hal/transport/byte_link.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::hal {

enum class PtuOutcome : std::uint8_t {
  Done,     ///< answered as it should be
  Refused,  ///< the unit answered with an error
  Failed,   ///< no answer, or none that can be believed; the line is in step again once ready()
};

/// What became of one command.
struct PtuAnswer {
  PtuCommand command;
  PtuOutcome outcome = PtuOutcome::Failed;
  double value = 0.0;
  bool axis_error = false;  ///< refused because the axis has not found its zero
  Stamp sent{};             ///< its last byte was on the line
  Stamp begun{};            ///< the reply began
};

/// Judges the line by what comes over it: whether replies keep coming later than they are waited for, do not
/// belong to what was asked, or drown in bytes that are no replies. Only for words: no reply is believed or
/// refused for it.
class PtuLineHealth {
 public:
  enum class Trouble : std::uint8_t { None, Late, Misfit, Noise };

  /// `command` went out; its last byte was on the line at `sent`, and its reply is waited for until
  /// `patience` later.
  void on_sent(const PtuCommand& command, Stamp sent, Stamp patience) noexcept;
  void on_byte(std::uint8_t byte) noexcept;
  /// The bytes since the last line are `line`, which was whole at `now`.
  void on_line(const PtuLine& line, Stamp now) noexcept;
  /// The bytes since the last line belong to none.
  void on_cut() noexcept;
  /// The unit was found at the line's rate: bytes of other rates do not count.
  void on_found() noexcept;
  /// Another line, or another device on it.
  void forget() noexcept;

  /// Lasts until a hundred replies in a row came as they should.
  [[nodiscard]] Trouble trouble() const noexcept { return trouble_; }
  /// How late replies come after their commands, when trouble() is Late.
  [[nodiscard]] Stamp lateness() const noexcept { return lateness_; }
  /// Bytes that were no replies, when trouble() is Noise.
  [[nodiscard]] std::uint64_t noise_bytes() const noexcept { return noise_bytes_; }

 private:
  enum class Verdict : std::uint8_t { Good, Late, Misfit };
  struct Sent {
    PtuCommand command;
    Stamp at{};
    Stamp patience{};
  };
  struct Judged {
    Verdict verdict = Verdict::Good;
    Stamp after{};  // its command; of a Misfit nothing
  };
  static constexpr std::size_t kSentMax = 16;
  static constexpr std::size_t kJudgedMax = 8;

  void on_reply(const PtuLine& line, Stamp now) noexcept;
  void note(Judged judged) noexcept;
  void judge_replies() noexcept;
  void judge_noise() noexcept;
  void drop(std::size_t count) noexcept;

  std::array<Sent, kSentMax> sent_;  // and not answered, oldest first
  std::size_t sent_size_ = 0;
  std::array<Judged, kJudgedMax> judged_;  // the last replies
  std::size_t judged_next_ = 0;
  Stamp late_{};  // of the last reply after its command, if it was late
  std::uint32_t late_in_row_ = 0;
  std::uint32_t good_in_row_ = 0;
  std::uint64_t line_bytes_ = 0;
  std::uint64_t noise_bytes_ = 0;
  std::uint64_t reply_bytes_ = 0;
  Trouble trouble_ = Trouble::None;
  Stamp lateness_{};
};

/// One command at a time on the line to the unit, and the answer that belongs to it.
///
/// Replies carry no number. What keeps them apart: a reply is believed only when its grammar, its echo and
/// its quantity fit the one command that is out. After anything else (time-out, a reply too many, a torn
/// line) no number is believed until the line was silent and a version query, whose answer no other reply
/// resembles, has come back: the unit answers in order, so nothing older can follow it. Answers of that query
/// itself are known wherever they turn up.
class PtuExchange {
 public:
  /// All three outlive this.
  PtuExchange(ByteLink& link, const PtuConfig& config, PtuCounters& counters) noexcept
      : link_(link), config_(config), counters_(counters) {}

  /// Forgets everything, also the version. Until the next version answer, errors only fail the command that
  /// is out: what else comes in is skipped.
  void reset(Stamp now) noexcept;

  /// Reads, judges, times out, drains and marks. Not while the link is down.
  void step(Stamp now) noexcept;

  /// Whether a command may be sent: none is out, no answer waits to be taken, the line is in step.
  [[nodiscard]] bool ready(Stamp now) const noexcept;

  /// Sends `command`, allowing `timeout` for the reply on top of line time. False, and nothing is sent, when
  /// the link cannot take it now. Only when ready().
  [[nodiscard]] bool send(const PtuCommand& command, Stamp timeout, Stamp now) noexcept;

  /// What became of the last command, once.
  [[nodiscard]] std::optional<PtuAnswer> take_answer() noexcept;

  /// The line could not be brought back in step, or command after command fails; reset() ends it.
  [[nodiscard]] bool lost() const noexcept { return lost_; }

  /// Grows with each thing on the line that ended being in step.
  [[nodiscard]] std::uint32_t disturbances() const noexcept { return disturbances_; }

  /// Last moment that something came in; the moment of the reset before.
  [[nodiscard]] Stamp heard() const noexcept { return heard_; }

  /// What of the unit's manner was noticed since the last call, once.
  struct Notices {
    bool banner = false;        ///< it was switched on
    bool echo = false;          ///< it echoes, or the line does
    bool plain = false;         ///< it answered without an echo
    bool verbose = false;       ///< it speaks in sentences
    bool terse = false;         ///< it answered with a mere number
    std::uint32_t replies = 0;  ///< lines in the grammar of a reply
    std::uint32_t marks = 0;
  };
  [[nodiscard]] Notices take_notices() noexcept;

  [[nodiscard]] PtuLineHealth& health() noexcept { return health_; }
  [[nodiscard]] const PtuLineHealth& health() const noexcept { return health_; }

  /// What the unit said of itself since the last reset().
  [[nodiscard]] std::string_view version() const noexcept { return version_.view(); }

 private:
  enum class State : std::uint8_t { Idle, Waiting, Draining, Marking };

  void on_line(const PtuLine& line) noexcept;
  void on_garbled(const PtuLine& line) noexcept;
  void on_banner(const PtuLine& line) noexcept;
  void on_reply(const PtuLine& line) noexcept;
  void on_answer(const PtuLine& line) noexcept;
  void note(const PtuMarks& marks) noexcept;
  void settle(PtuOutcome outcome) noexcept;
  void disturb() noexcept;
  void watch(Stamp now) noexcept;
  void mark(Stamp now) noexcept;
  [[nodiscard]] Stamp on_line_for(std::size_t bytes) const noexcept;
  [[nodiscard]] bool is_version(const PtuLine& line) const noexcept;
  [[nodiscard]] bool in_step_known() const noexcept { return !version_.view().empty(); }

  ByteLink& link_;
  const PtuConfig& config_;
  PtuCounters& counters_;
  PtuReplyParser parser_;
  PtuLineHealth health_;
  PtuCommand out_;       // sent last
  bool echoed_ = false;  // it came back on a line of its own
  FixedText<kPtuLineMax> version_;
  State state_ = State::Idle;
  PtuAnswer answer_;
  bool answered_ = false;
  Stamp deadline_{};
  Stamp drain_end_{};
  Stamp heard_{};
  std::optional<Stamp> banner_;  // its last line
  Stamp now_{};
  std::uint32_t failures_ = 0;  // in a row
  std::uint32_t marks_sent_ = 0;
  std::uint32_t disturbances_ = 0;
  bool lost_ = false;
  Notices notices_;
};

}  // namespace slamsensor::hal
