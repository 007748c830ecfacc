#include "hal/pantilt/ptu_exchange.hpp"

#include <algorithm>
#include <array>

namespace slamsensor::hal {
namespace {

constexpr std::size_t kReadMax = 128;
constexpr int kReadsPerStep = 16;
constexpr std::size_t kReplyMax = 80;                    // bytes: a sentence with its echo
constexpr std::size_t kGuardBytes = 3;                   // of silence between a reply and the next command
constexpr std::uint32_t kFailuresMax = 6;                // commands in a row
constexpr std::uint32_t kMarksMax = 3;                   // version queries in a row
constexpr Stamp kBannerLines = std::chrono::seconds(1);  // one after the other
constexpr Stamp kDrainMax = std::chrono::seconds(2);

constexpr Stamp kPrompt = std::chrono::milliseconds(20);  // after its command, at most
constexpr Stamp kEarly = std::chrono::milliseconds(5);    // of a stamp
constexpr Stamp kNoReplyAfter = std::chrono::seconds(6);  // a command whose reply is not expected any more
constexpr std::size_t kBadReplies = 3;                    // of the last kJudgedMax: one may be a lost byte
constexpr std::uint32_t kGoodReplies = 100;               // in a row: the trouble is over
constexpr std::uint32_t kInStep = 8;                      // good replies in a row: none is owed any more
constexpr std::uint64_t kNoiseBytes = 48;                 // two sentences of a unit at another rate
constexpr std::uint64_t kNoiseShare = 2;                  // times the bytes of replies
constexpr std::uint64_t kBytesKept = 1'000'000;

bool fits(const PtuCommand& command, const PtuLine& line) noexcept {
  if (!line.echo.empty() && !ptu_same_text(line.echo, command.text())) {
    return false;
  }
  return line.kind == PtuLineKind::Refusal || ptu_match(command, line.payload).has_value();
}

}  // namespace

void PtuLineHealth::on_sent(const PtuCommand& command, Stamp sent, Stamp patience) noexcept {
  std::size_t old = sent_size_ == kSentMax ? 1 : 0;
  while (old < sent_size_ && sent_[old].at + kNoReplyAfter < sent) {
    ++old;
  }
  drop(old);
  sent_[sent_size_++] = {command, sent, patience};
}

void PtuLineHealth::on_byte(std::uint8_t byte) noexcept {
  line_bytes_ += byte == ' ' || byte == '\r' || byte == '\n' ? 0 : 1;
}

void PtuLineHealth::on_line(const PtuLine& line, Stamp now) noexcept {
  const bool is_reply = line.kind == PtuLineKind::Success || line.kind == PtuLineKind::Refusal;
  const auto is_any = [this](const auto& holds) {
    return std::any_of(sent_.begin(), sent_.begin() + static_cast<std::ptrdiff_t>(sent_size_), holds);
  };
  const bool is_sound =
      is_reply && (line.echo.empty() || is_any([&](const Sent& sent) { return fits(sent.command, line); }));
  const bool is_echo = line.kind == PtuLineKind::Garbled && is_any([&](const Sent& sent) {
                         return ptu_same_text(line.payload, sent.command.text());
                       });
  if (is_sound || is_echo || line.kind == PtuLineKind::Banner) {
    reply_bytes_ += line_bytes_;
    line_bytes_ = 0;
  }
  on_cut();
  if (is_sound) {
    on_reply(line, now);
  }
}

void PtuLineHealth::on_cut() noexcept {
  noise_bytes_ += line_bytes_;
  line_bytes_ = 0;
  if (noise_bytes_ + reply_bytes_ > kBytesKept) {
    noise_bytes_ /= 2;
    reply_bytes_ /= 2;
  }
  judge_noise();
}

void PtuLineHealth::on_found() noexcept {
  noise_bytes_ = 0;
  reply_bytes_ = 0;
  if (trouble_ == Trouble::Noise) {
    trouble_ = Trouble::None;
  }
}

void PtuLineHealth::forget() noexcept {
  *this = {};
}

/// A unit answers in the order of its commands, so a reply belongs to the oldest one that it fits. But one
/// right behind the newest command is its answer, and those to the commands before were lost, unless it is as
/// late for the oldest as the replies before were.
void PtuLineHealth::on_reply(const PtuLine& line, Stamp now) noexcept {
  std::size_t of = 0;
  while (of < sent_size_ && !fits(sent_[of].command, line)) {
    ++of;
  }
  if (of == sent_size_) {
    note({Verdict::Misfit, {}});
    return;
  }
  const Stamp after = line.begun - sent_[of].at;
  const Sent& newest = sent_[sent_size_ - 1];
  const bool is_prompt =
      fits(newest.command, line) && line.begun + kEarly >= newest.at && line.begun <= newest.at + kPrompt;
  const bool is_late_as_before = late_in_row_ >= 2 && std::chrono::abs(after - late_) < late_ / 5;
  of = is_prompt && !is_late_as_before ? sent_size_ - 1 : of;
  const Sent sent = sent_[of];
  if (is_prompt && !is_late_as_before && good_in_row_ < kInStep) {
    --sent_size_;  // by chance, perhaps: the older ones may still be answered
  } else {
    drop(of + 1);
  }
  const bool is_late = now > sent.at + sent.patience;
  late_in_row_ = is_late ? late_in_row_ + 1 : 0;
  late_ = is_late ? line.begun - sent.at : Stamp{};
  note({is_late ? Verdict::Late : Verdict::Good, line.begun - sent.at});
}

void PtuLineHealth::note(Judged judged) noexcept {
  judged_[judged_next_] = judged;
  judged_next_ = (judged_next_ + 1) % kJudgedMax;
  good_in_row_ = judged.verdict == Verdict::Good ? good_in_row_ + 1 : 0;
  if (good_in_row_ >= kGoodReplies) {
    trouble_ = Trouble::None;
    noise_bytes_ = 0;
    reply_bytes_ = 0;
  } else if (judged.verdict != Verdict::Good) {
    judge_replies();
  }
}

/// Replies of a line or a unit that is late all come about as late as one another; among replies that were
/// swapped or doubled many come at once, or belong to nothing.
void PtuLineHealth::judge_replies() noexcept {
  std::size_t late = 0;
  std::size_t misfit = 0;
  Stamp latest{};
  for (const Judged& judged : judged_) {
    late += judged.verdict == Verdict::Late ? 1 : 0;
    misfit += judged.verdict == Verdict::Misfit ? 1 : 0;
    latest = std::max(latest, judged.after);
  }
  if (late + misfit < kBadReplies || trouble_ == Trouble::Noise) {
    return;
  }
  const auto prompt =
      static_cast<std::size_t>(std::count_if(judged_.begin(), judged_.end(), [latest](const Judged& judged) {
        return judged.verdict == Verdict::Good && judged.after > Stamp{} && 2 * judged.after < latest;
      }));
  trouble_ = late >= kBadReplies && late > 2 * (misfit + prompt) ? Trouble::Late : Trouble::Misfit;
  lateness_ = trouble_ == Trouble::Late && late_ > Stamp{} ? late_ : latest;
}

void PtuLineHealth::judge_noise() noexcept {
  if (noise_bytes_ >= kNoiseBytes && noise_bytes_ > kNoiseShare * reply_bytes_) {
    trouble_ = Trouble::Noise;
  }
}

void PtuLineHealth::drop(std::size_t count) noexcept {
  std::move(sent_.begin() + static_cast<std::ptrdiff_t>(count),
            sent_.begin() + static_cast<std::ptrdiff_t>(sent_size_), sent_.begin());
  sent_size_ -= count;
}

void PtuExchange::reset(Stamp now) noexcept {
  parser_.clear();
  health_.on_cut();
  version_ = {};
  state_ = State::Idle;
  answered_ = false;
  heard_ = now;
  failures_ = 0;
  marks_sent_ = 0;
  lost_ = false;
  notices_ = {};
}

void PtuExchange::step(Stamp now) noexcept {
  now_ = now;
  std::array<std::uint8_t, kReadMax> bytes{};
  for (int reads = 0; reads < kReadsPerStep; ++reads) {
    const ByteRead read = link_.read(bytes);
    if (read.status != LinkStatus::Ok) {
      break;
    }
    heard_ = std::max(heard_, read.stamp);
    const std::size_t count = std::min(read.count, bytes.size());
    for (std::size_t i = 0; i < count; ++i) {
      // Bytes read together came one after the other: this one began so long before the read at the latest.
      const Stamp begun = read.stamp - on_line_for(count - i);
      health_.on_byte(bytes[i]);
      if (const std::optional<PtuLine> line = parser_.push(bytes[i], begun)) {
        health_.on_line(*line, now);
        on_line(*line);
      }
    }
  }
  watch(now);
}

bool PtuExchange::ready(Stamp now) const noexcept {
  return state_ == State::Idle && !answered_ && !lost_ &&
         now >= heard_ + line_time(kGuardBytes, link_.baud());
}

bool PtuExchange::send(const PtuCommand& command, Stamp timeout, Stamp now) noexcept {
  std::array<std::uint8_t, kPtuCommandMax> bytes{};
  const std::size_t size = command.write(bytes);
  if (size == 0 || link_.write(std::span(bytes).first(size)) != LinkStatus::Ok) {
    return false;
  }
  const std::size_t reply_max = command.expect() == PtuExpect::Version ? kPtuLineMax : kReplyMax;
  answer_ = {.command = command, .sent = now + on_line_for(size)};
  deadline_ = answer_.sent + timeout + line_time(reply_max, link_.baud());
  note(parser_.cut());
  out_ = command;
  echoed_ = false;
  health_.on_sent(command, answer_.sent, deadline_ - answer_.sent);
  state_ = State::Waiting;
  return true;
}

std::optional<PtuAnswer> PtuExchange::take_answer() noexcept {
  if (!answered_) {
    return std::nullopt;
  }
  answered_ = false;
  return answer_;
}

PtuExchange::Notices PtuExchange::take_notices() noexcept {
  const Notices notices = notices_;
  notices_ = {};
  return notices;
}

void PtuExchange::note(const PtuMarks& marks) noexcept {
  counters_.count(PtuEvent::LimitReports, marks.limits);
  counters_.count(PtuEvent::TriggerReports, marks.triggers);
  counters_.count(PtuEvent::CableReports, marks.cables);
  notices_.marks += marks.limits + marks.triggers + marks.cables;
}

void PtuExchange::on_line(const PtuLine& line) noexcept {
  note(line.marks);
  switch (line.kind) {
    case PtuLineKind::Banner:
      on_banner(line);
      return;
    case PtuLineKind::Overlong:
      counters_.count(PtuEvent::LinesOverlong);
      disturb();
      return;
    case PtuLineKind::Garbled:
      on_garbled(line);
      return;
    case PtuLineKind::Success:
    case PtuLineKind::Refusal:
      ++notices_.replies;
      on_reply(line);
      return;
  }
}

/// Where an echo ends a line, it is a line of its own.
void PtuExchange::on_garbled(const PtuLine& line) noexcept {
  if (line.payload.empty()) {
    return;
  }
  if ((state_ == State::Waiting || state_ == State::Marking) && ptu_same_text(line.payload, out_.text())) {
    counters_.count(PtuEvent::EchoesStripped);
    notices_.echo = true;
    echoed_ = true;
    return;
  }
  counters_.count(PtuEvent::RepliesGarbled);
  disturb();
}

/// A banner has several lines at its beginning, and one that ends with the reset.
void PtuExchange::on_banner(const PtuLine& line) noexcept {
  notices_.banner = true;
  if (line.payload.front() == '#') {
    counters_.count(PtuEvent::PowerCycles, !banner_ || now_ >= *banner_ + kBannerLines ? 1 : 0);
    banner_ = now_;
  }
}

void PtuExchange::on_reply(const PtuLine& line) noexcept {
  const bool version = is_version(line);
  if (state_ == State::Marking && version) {
    state_ = State::Idle;
    marks_sent_ = 0;
    return;
  }
  const bool awaited = state_ == State::Waiting && answer_.command.expect() == PtuExpect::Version;
  if (state_ == State::Draining || state_ == State::Marking || (version && !awaited)) {
    counters_.count(PtuEvent::RepliesLate);
    return;
  }
  if (state_ == State::Waiting) {
    on_answer(line);
    return;
  }
  counters_.count(PtuEvent::RepliesUnexpected);
  disturb();
}

void PtuExchange::on_answer(const PtuLine& line) noexcept {
  const PtuCommand& command = answer_.command;
  const bool echo_fits = line.echo.empty() || ptu_same_text(line.echo, command.text());
  const std::optional<PtuMatch> match =
      line.kind == PtuLineKind::Success ? ptu_match(command, line.payload) : std::nullopt;
  const bool refused = line.kind == PtuLineKind::Refusal;
  // What began before the command was out is the answer to something else.
  const bool early = in_step_known() && line.begun + on_line_for(1) < answer_.sent;
  if (early || !echo_fits || !(match || refused)) {
    counters_.count(PtuEvent::RepliesUnexpected);
    disturb();
    return;
  }
  answer_.begun = std::max(line.begun, answer_.sent);
  const PtuMatch said = match.value_or(PtuMatch{});
  answer_.value = said.value;
  answer_.axis_error = refused && ptu_same_text(line.payload.substr(0, 10), "Axis Error");
  counters_.count(PtuEvent::EchoesStripped, line.echo.empty() ? 0 : 1);
  notices_.plain = line.echo.empty() && !echoed_;
  notices_.echo = notices_.echo || !line.echo.empty();
  notices_.verbose = notices_.verbose || said.verbose;
  const bool is_number = command.expect() == PtuExpect::Position || command.expect() == PtuExpect::Number;
  notices_.terse = is_number && match && !said.verbose;
  if (match && command.expect() == PtuExpect::Version) {
    version_ = FixedText<kPtuLineMax>(line.payload);
  }
  failures_ = 0;
  settle(refused ? PtuOutcome::Refused : PtuOutcome::Done);
}

void PtuExchange::settle(PtuOutcome outcome) noexcept {
  answer_.outcome = outcome;
  answered_ = true;
  state_ = State::Idle;
}

void PtuExchange::disturb() noexcept {
  if (!in_step_known() || state_ == State::Draining || state_ == State::Marking) {
    return;
  }
  ++disturbances_;
  if (state_ == State::Waiting || answered_) {
    // An answer that nobody has taken yet may be the one too many.
    settle(PtuOutcome::Failed);
  }
  counters_.count(PtuEvent::Resyncs);
  lost_ = ++failures_ >= kFailuresMax;
  marks_sent_ = 0;
  state_ = State::Draining;
  drain_end_ = now_ + kDrainMax;
  heard_ = std::max(heard_, now_);
}

void PtuExchange::watch(Stamp now) noexcept {
  if (state_ == State::Waiting && now >= deadline_) {
    counters_.count(PtuEvent::Timeouts);
    if (in_step_known()) {
      disturb();
    } else {
      settle(PtuOutcome::Failed);
    }
  } else if (state_ == State::Draining && (now >= heard_ + config_.drain || now >= drain_end_)) {
    mark(now);
  } else if (state_ == State::Marking && now >= deadline_) {
    counters_.count(PtuEvent::Timeouts);
    lost_ = lost_ || marks_sent_ >= kMarksMax;
    state_ = State::Draining;
    drain_end_ = now + kDrainMax;
  }
}

void PtuExchange::mark(Stamp now) noexcept {
  if (lost_) {
    return;
  }
  const PtuAnswer kept = answer_;
  if (send(PtuCommand("V", PtuExpect::Version), config_.mode_timeout, now)) {
    ++marks_sent_;
    state_ = State::Marking;
  }
  answer_ = kept;
}

Stamp PtuExchange::on_line_for(std::size_t bytes) const noexcept {
  return config_.pacing == PtuPacing::LineRate ? line_time(bytes, link_.baud()) : Stamp{};
}

bool PtuExchange::is_version(const PtuLine& line) const noexcept {
  return line.kind == PtuLineKind::Success && in_step_known() &&
         FixedText<kPtuLineMax>(line.payload).view() == version_.view();
}

}  // namespace slamsensor::hal
