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

}  // namespace

void PtuExchange::reset(Stamp now) noexcept {
  parser_.clear();
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
      if (const std::optional<PtuLine> line = parser_.push(bytes[i], begun)) {
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
      if (!line.payload.empty()) {
        counters_.count(PtuEvent::RepliesGarbled);
        disturb();
      }
      return;
    case PtuLineKind::Success:
    case PtuLineKind::Refusal:
      ++notices_.replies;
      on_reply(line);
      return;
  }
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
  answer_.value = match ? match->value : 0.0;
  answer_.axis_error = refused && ptu_same_text(line.payload.substr(0, 10), "Axis Error");
  notices_.echo = notices_.echo || !line.echo.empty();
  notices_.verbose = notices_.verbose || (match && match->verbose);
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
