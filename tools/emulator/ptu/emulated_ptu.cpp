// How the unit hears and answers.
#include "tools/emulator/ptu/emulated_ptu.hpp"

#include "tools/emulator/ptu/ascii_command.hpp"
#include "tools/emulator/ptu/cpi_command.hpp"

#include <algorithm>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kTextMax = 64;  // longer commands do not exist

bool is_line_end(char c) {
  return c == '\r' || c == '\n';
}

}  // namespace

EmulatedPtu::EmulatedPtu(const PtuSettings& settings, ByteSink& sink, std::uint64_t seed, Stamp start)
    : settings_(settings),
      sink_(sink),
      unit_(settings_, mix_seed(seed, 0)),
      port_(sink, settings.output_capacity, mix_seed(seed, 1)),
      latency_(settings.reply_latency, mix_seed(seed, 2)),
      rng_(mix_seed(seed, 3)),
      baud_(settings.factory_baud) {
  if (settings.begin == PtuBegin::PowerUp) {
    power_on(start);
  }
}

bool EmulatedPtu::is_reading() const {
  const bool can_answer = !reset_ || reset_->input == PtuStarting::Answers;
  return has_power_ && greet_at_ == hal::kNever && !pending_ && can_answer;
}

void EmulatedPtu::receive(std::uint8_t byte, Stamp at) {
  const bool is_deaf = greet_at_ != hal::kNever || (reset_ && reset_->input == PtuStarting::Drops);
  if (!has_power_ || is_deaf || input_.size() >= settings_.input_capacity) {
    ++dropped_bytes_;
    return;
  }
  const bool is_pair = std::exchange(has_heard_return_, byte == '\r') && byte == '\n';
  // A scan ends at once, even when an answer is still to come.
  if (unit_.head.is_monitoring() && !is_pair) {
    end_monitor(at);
    return;
  }
  input_.push_back(byte);
  settle(at);
}

void EmulatedPtu::process(Stamp now) {
  while (is_reading() && !input_.empty()) {
    const std::uint8_t byte = input_.front();
    input_.pop_front();
    take(byte, now);
  }
}

void EmulatedPtu::take(std::uint8_t byte, Stamp now) {
  if (!binary_.empty()) {
    take_binary(byte, now);
    return;
  }
  const bool was_return = std::exchange(was_return_, byte == '\r');
  if (byte == '\n' && (was_return || settings_.line_feed == PtuLineFeed::Ignored)) {
    return;
  }
  if (unit_.head.is_monitoring()) {
    end_monitor(now);
  } else if (pass_through(byte)) {
    return;
  } else if (byte >= kCpiOpcodeMin && text_.empty()) {
    take_binary(byte, now);
  } else {
    take_text(static_cast<char>(byte), now);
  }
}

void EmulatedPtu::end_monitor(Stamp now) {
  unit_.head.end_monitor(now);
  text_.clear();
}

// Whether `byte` went to a device behind an expansion port.
bool EmulatedPtu::pass_through(std::uint8_t byte) {
  auto& passing = unit_.pass_through;
  if (!passing) {
    return false;
  }
  if (passing->left == 0) {
    if (byte == '@') {
      passing.reset();
      return false;
    }
    return true;
  }
  if (--passing->left == 0) {
    passing.reset();
  }
  return true;
}

void EmulatedPtu::take_binary(std::uint8_t byte, Stamp now) {
  binary_.push_back(byte);
  if (binary_.size() <= cpi_argument_size(binary_.front(), settings_.model.series)) {
    return;
  }
  const std::vector<std::uint8_t> command = std::exchange(binary_, {});
  form_ = PtuForm::Binary;
  if (unit_.is_addressed()) {
    begin_answer(obey_cpi(unit_, command, now), now);
  }
}

void EmulatedPtu::take_text(char c, Stamp now) {
  if (c == ' ' || is_line_end(c)) {
    end_text(c, now);
    return;
  }
  if (unit_.head.config.echo == PtuEcho::On && unit_.may_speak()) {
    port_.say({&c, 1}, now);
  }
  if (text_.size() < kTextMax) {
    text_ += c;
  }
}

void EmulatedPtu::end_text(char delimiter, Stamp now) {
  const std::string text = std::exchange(text_, {});
  if (unit_.may_speak()) {
    const bool is_line = is_line_end(delimiter);
    if (unit_.head.config.echo == PtuEcho::On) {
      port_.say(is_line ? "\r\n" : " ", now);
    } else if (is_line && settings_.leading_lf == PtuLeadingLf::AfterLine) {
      port_.say("\n", now);
    }
  }
  if (!text.empty() && (unit_.is_addressed() || text.front() == '_')) {
    form_ = PtuForm::Ascii;
    begin_answer(obey_ascii(unit_, text, now), now);
  }
}

void EmulatedPtu::choose_audience(Stamp now) {
  port_.turn_to(unit_.may_speak() ? PtuAudience::Host : PtuAudience::Store, now);
}

void EmulatedPtu::begin_answer(const PtuAnswer& answer, Stamp now) {
  choose_audience(now);
  if (answer.bytes.empty()) {
    return;
  }
  if (answer.wait == PtuAnswer::Wait::Reset) {
    begin_reset(answer.reset, {.answer = answer}, now);
    return;
  }
  const Stamp latency = latency_.draw() + std::exchange(late_, Stamp{});
  const Stamp wait = answer.wait == PtuAnswer::Wait::Time ? answer.time : Stamp{};
  pending_ = Pending{now + wait + latency, answer, latency};
}

// A unit that awaits its motion notices the end when it comes, whatever changes that meanwhile.
Stamp EmulatedPtu::pending_due() const {
  if (pending_->answer.wait != PtuAnswer::Wait::Motion || pending_->has_answered) {
    return pending_->due;
  }
  return std::max(pending_->due, unit_.head.still_from() + pending_->latency);
}

void EmulatedPtu::finish_pending(Stamp now) {
  Pending done = std::move(*pending_);
  pending_.reset();
  const auto rate = done.answer.baud;
  if (rate && (done.has_answered || settings_.baud_reply == PtuBaudReply::NewRate)) {
    baud_ = *rate;
  }
  if (done.has_answered) {
    return;
  }
  port_.answer(done.answer.bytes, done.answer.form, now);
  if (rate && settings_.baud_reply == PtuBaudReply::OldRate) {
    done.has_answered = true;
    done.due = std::max(now, sink_.busy_until());
    pending_ = std::move(done);
  }
}

}  // namespace slamsensor::tools
