#include "firmware/config/rows/point_lists.hpp"

#include "hal/rangefinder/point_record.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace slamsensor::firmware::rows {
namespace {

// In the order of hal::Echo; a return is a distance and needs no code.
constexpr std::array<std::string_view, 5> kEchoNames = {"return", "none", "weak", "saturated", "fault"};

std::optional<hal::Echo> parse_echo(std::string_view name) {
  const auto found = std::find(kEchoNames.begin() + 1, kEchoNames.end(), name);
  if (found == kEchoNames.end()) {
    return std::nullopt;
  }
  return static_cast<hal::Echo>(found - kEchoNames.begin());
}

std::string text_of(std::string said, hal::Echo echo) {
  return std::move(said) + '=' + std::string(kEchoNames[static_cast<std::size_t>(echo)]);
}

template <typename Value>
std::vector<Value> parsed(const std::vector<std::string>& items,
                          std::optional<Value> (*parse)(std::string_view)) {
  std::vector<Value> values;
  for (const std::string& item : items) {
    if (std::optional<Value> value = parse(item)) {
      values.push_back(std::move(*value));
    }
  }
  return values;
}

}  // namespace

std::optional<hal::PointCode> parse_point_code(std::string_view item) {
  hal::PointCode code;
  const auto [end, error] = std::from_chars(item.data(), item.data() + item.size(), code.number);
  const std::string_view rest = item.substr(static_cast<std::size_t>(end - item.data()));
  if (error != std::errc() || !rest.starts_with('=')) {
    return std::nullopt;
  }
  const std::optional<hal::Echo> echo = parse_echo(rest.substr(1));
  if (!echo) {
    return std::nullopt;
  }
  code.echo = *echo;
  return code;
}

std::optional<hal::PointText> parse_point_text(std::string_view item) {
  const std::size_t equals = item.rfind('=');
  if (equals == std::string_view::npos || equals == 0 || equals > hal::kPointTextMax) {
    return std::nullopt;
  }
  const std::string_view text = item.substr(0, equals);
  const std::optional<hal::Echo> echo = parse_echo(item.substr(equals + 1));
  if (!echo || std::any_of(text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; })) {
    return std::nullopt;
  }
  return hal::PointText{std::string(text), *echo};
}

std::vector<hal::PointCode> point_codes(const std::vector<std::string>& items) {
  return parsed(items, parse_point_code);
}

std::vector<hal::PointText> point_texts(const std::vector<std::string>& items) {
  return parsed(items, parse_point_text);
}

std::vector<std::string> texts_of(const std::vector<hal::PointCode>& codes) {
  std::vector<std::string> items;
  for (const hal::PointCode& code : codes) {
    items.push_back(text_of(std::to_string(code.number), code.echo));
  }
  return items;
}

std::vector<std::string> texts_of(const std::vector<hal::PointText>& texts) {
  std::vector<std::string> items;
  for (const hal::PointText& text : texts) {
    items.push_back(text_of(text.text, text.echo));
  }
  return items;
}

}  // namespace slamsensor::firmware::rows
