#include "tools/emulator/rangefinder/emulated_lwnx.hpp"

#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kLineMax = 32;  // characters, as the LW20/SF20 manual says

}  // namespace

void EmulatedLwnx::take_text(std::uint8_t byte, Stamp at) {
  const char c = static_cast<char>(byte);
  const bool is_bare_d = text_.empty() && (c == 'd' || c == 'D') && unanswered_first_ == 0;
  if (is_bare_d) {
    put_text(legacy_distance(text_range_m(measure(at))), at, {&at, 1});
  } else if (c == '\r' || c == '\n') {
    const std::string line = std::move(text_);
    text_.clear();
    if (!line.empty()) {
      take_line(line, at);
    }
  } else if (text_.size() < kLineMax) {
    text_.push_back(c);
  }
}

void EmulatedLwnx::take_line(std::string_view line, Stamp at) {
  if (unanswered_first_ > 0) {
    --unanswered_first_;
    text_at_ = settings_.screen_period > Stamp::zero() ? at + settings_.screen_period : text_at_;
    return;
  }
  if (const auto command = parse_text_command(line)) {
    answer_text(*command, at);
  } else {
    ++refused_;
  }
}

void EmulatedLwnx::answer_text(const LwnxTextCommand& command, Stamp at) {
  const LwnxTextStyle style = product_.text_style;
  switch (command.kind) {
    case LwnxTextKind::Product:
      put_text(product_answer(product_), at);
      break;
    case LwnxTextKind::Distance:
      if (command.prefix == '$') {
        text_stream_ = command;
        retime(at);
      } else {
        put_text(text_answer(style, command, metres_text(text_range_m(measure(at)))), at, {&at, 1});
      }
      break;
    case LwnxTextKind::Strength: {
      const LwnxReading reading = measure(at);
      put_text(text_answer(style, command, std::to_string(std::llround(reading.strength))), at);
      break;
    }
    case LwnxTextKind::Temperature:
      put_text(text_answer(style, command, "23.5"), at);
      break;
    case LwnxTextKind::Baud:
      set_baud_by_text(command);
      put_text(text_answer(style, command, std::to_string(registers_.value(product_.ids.baud))), at);
      break;
    case LwnxTextKind::Save:
      registers_.save();
      put_text(command.key == "P" ? "%p:\r\n" : "%c:\r\n", at);
      break;
    case LwnxTextKind::Stop:
      text_stream_.reset();
      retime(at);
      break;
  }
}

void EmulatedLwnx::set_baud_by_text(const LwnxTextCommand& command) {
  const auto value = static_cast<std::uint64_t>(command.value.value_or(-1));
  if (command.prefix == '#' && lwnx_baud(value)) {
    registers_.set(product_.ids.baud, value);
  }
}

double EmulatedLwnx::text_range_m(const LwnxReading& reading) const {
  return reading.is_lost ? settings_.text_no_return_m : reading.range_m;
}

void EmulatedLwnx::put_text(std::string_view text, Stamp at, std::span<const Stamp> measured) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  machine_.outbox.put_answer(bytes, at, measured);
}

}  // namespace slamsensor::tools
