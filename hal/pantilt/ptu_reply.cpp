#include "hal/pantilt/ptu_reply.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr std::size_t kDigitsMax = 15;  // exact in a double
constexpr double kPositionMax = 1e6;

char lower(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool is_lower(char c) noexcept {
  return c >= 'a' && c <= 'z';
}

bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}

std::string_view trimmed(std::string_view text) noexcept {
  while (!text.empty() && text.front() == ' ') {
    text.remove_prefix(1);
  }
  while (!text.empty() && text.back() == ' ') {
    text.remove_suffix(1);
  }
  return text;
}

bool contains(std::string_view text, std::string_view word) noexcept {
  return std::search(text.begin(), text.end(), word.begin(), word.end(),
                     [](char a, char b) { return lower(a) == lower(b); }) != text.end();
}

/// Counts the mark at the beginning of `text`, if there is one.
bool take_mark(std::string_view text, PtuMarks& marks) noexcept {
  if (text.size() < 2 || (text.size() > 2 && is_lower(text[2]))) {
    return false;
  }
  const bool of_axis = text[1] == 'P' || text[1] == 'T';
  if (text[0] == '!' && of_axis) {
    ++marks.limits;
  } else if ((text[0] == '#' || text[0] == '$') && of_axis) {
    ++marks.triggers;
  } else if (text[0] == '!' && text[1] == 'D') {
    ++marks.cables;
  } else {
    return false;
  }
  return true;
}

/// A refusal's message is words; anything else is a mark that has lost a byte.
PtuLineKind kind_of(char mark, std::string_view payload) noexcept {
  if (mark == '*') {
    return PtuLineKind::Success;
  }
  const bool words = payload.size() >= 2 && !is_digit(payload[0]) && is_lower(lower(payload[0])) &&
                     is_lower(lower(payload[1]));
  return words ? PtuLineKind::Refusal : PtuLineKind::Garbled;
}

PtuLine line_of(std::string_view text) noexcept {
  PtuLine line;
  text = trimmed(text);
  const std::size_t mark = text.find_first_of("*!");
  line.echo = trimmed(text.substr(0, std::min(mark, text.size())));
  if (text.substr(0, 2) == "##" || contains(line.echo, "nitializing")) {
    line.kind = PtuLineKind::Banner;
    line.echo = {};
    line.payload = text;
    return line;
  }
  if (mark == std::string_view::npos) {
    line.payload = text;
    line.echo = {};
    return line;
  }
  line.payload = trimmed(text.substr(mark + 1));
  line.kind = kind_of(text[mark], line.payload);
  return line;
}

std::optional<PtuQuantity> quantity_of(std::string_view text) noexcept {
  if (contains(text, "arc")) {
    return PtuQuantity::Resolution;
  }
  if (contains(text, "accel")) {
    return PtuQuantity::Acceleration;
  }
  const bool least = contains(text, "minimum");
  const bool most = contains(text, "maximum");
  if (contains(text, "speed")) {
    if (contains(text, "base")) {
      return PtuQuantity::BaseSpeed;
    }
    return least ? PtuQuantity::SpeedMin : most ? PtuQuantity::SpeedMax : PtuQuantity::Speed;
  }
  if (contains(text, "position")) {
    return least ? PtuQuantity::MinPosition : most ? PtuQuantity::MaxPosition : PtuQuantity::Position;
  }
  return std::nullopt;
}

}  // namespace

std::optional<PtuLine> PtuReplyParser::push(std::uint8_t byte, Stamp stamp) noexcept {
  const char c = static_cast<char>(byte);
  if (c == '\r' || c == '\n') {
    if (!in_line()) {
      return std::nullopt;
    }
    const PtuLine line = finish();
    clear();
    return line;
  }
  if (size_ == 0 && !overlong_) {
    if (c == ' ') {
      return std::nullopt;
    }
    begun_ = stamp;
  }
  if ((c == '*' || c == '!') && !marked_) {
    // A '!' may yet turn out to be a mark in front of the reply: only '*' settles it.
    marked_ = c == '*';
    begun_ = stamp;
  }
  if (size_ == text_.size()) {
    overlong_ = true;
    return std::nullopt;
  }
  text_[size_++] = c;
  return std::nullopt;
}

void PtuReplyParser::clear() noexcept {
  size_ = 0;
  overlong_ = false;
  marked_ = false;
}

PtuMarks PtuReplyParser::cut() noexcept {
  const PtuMarks marks = in_line() ? finish().marks : PtuMarks{};
  clear();
  return marks;
}

PtuLine PtuReplyParser::finish() noexcept {
  PtuLine line;
  if (overlong_) {
    line.kind = PtuLineKind::Overlong;
    line.begun = begun_;
    return line;
  }
  PtuMarks marks;
  std::size_t kept = 0;
  const std::string_view text(text_.data(), size_);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (take_mark(text.substr(i), marks)) {
      ++i;
    } else {
      text_[kept++] = text[i];
    }
  }
  line = line_of(std::string_view(text_.data(), kept));
  line.marks = marks;
  line.begun = begun_;
  return line;
}

std::optional<double> ptu_number(std::string_view text) noexcept {
  const bool negative = !text.empty() && text.front() == '-';
  if (negative || (!text.empty() && text.front() == '+')) {
    text.remove_prefix(1);
  }
  const std::size_t point = text.find('.');
  const std::size_t decimals = point == std::string_view::npos ? 0 : text.size() - point - 1;
  const std::size_t digits = text.size() - (point == std::string_view::npos ? 0 : 1);
  if (digits == 0 || digits > kDigitsMax || point == 0) {
    return std::nullopt;
  }
  double value = 0.0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (i == point) {
      continue;
    }
    if (!is_digit(text[i])) {
      return std::nullopt;
    }
    value = value * 10.0 + (text[i] - '0');
  }
  double scale = 1.0;
  for (std::size_t i = 0; i < decimals; ++i) {
    scale *= 10.0;
  }
  return negative ? -(value / scale) : value / scale;
}

std::optional<std::int32_t> ptu_position(std::string_view text) noexcept {
  const std::optional<double> number = ptu_number(text);
  if (!number || text.find('.') != std::string_view::npos || *number > kPositionMax ||
      *number < -kPositionMax) {
    return std::nullopt;
  }
  return static_cast<std::int32_t>(*number);
}

std::optional<PtuSentence> ptu_sentence(std::string_view payload) noexcept {
  std::optional<double> value;
  std::string_view rest = payload;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    const std::optional<double> number = ptu_number(rest.substr(0, end));
    if (number && value) {
      return std::nullopt;
    }
    value = number ? number : value;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  const std::optional<PtuQuantity> quantity = quantity_of(payload);
  if (!value || !quantity) {
    return std::nullopt;
  }
  const bool pan = contains(payload, "pan");
  const bool tilt = contains(payload, "tilt");
  PtuSentence sentence{*value, *quantity, std::nullopt};
  if (pan != tilt) {
    sentence.axis = pan ? Axis::Pan : Axis::Tilt;
  }
  return sentence;
}

bool ptu_same_text(std::string_view a, std::string_view b) noexcept {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace slamsensor::hal
