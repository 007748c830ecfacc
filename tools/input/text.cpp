#include "tools/input/text.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace slamsensor::tools {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBlanks = " \t";
constexpr std::string_view kBlanksAndReturn = " \t\r";

// from_chars knows no '+', yet many programs write one.
std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  return plus ? text.substr(1) : text;
}

template <typename T>
std::optional<T> parse_all(std::string_view text) {
  text = without_plus(text);
  T value{};
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  return parse_all<double>(text);
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  return parse_all<std::int64_t>(text);
}

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanksAndReturn);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlanksAndReturn) - first + 1);
}

bool same_but_for_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

std::string_view take_word(std::string_view& rest) {
  const std::size_t first = rest.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    rest = {};
    return {};
  }
  const std::size_t end = rest.find_first_of(kBlanks, first);
  const std::string_view word = rest.substr(first, end - first);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end);
  return word;
}

LineReader::LineReader(std::string_view text, std::size_t first_line) : text_(text), number_(first_line - 1) {
  if (text.starts_with(kByteOrderMark)) {
    at_ = kByteOrderMark.size();
  }
}

bool LineReader::next() {
  while (at_ < text_.size()) {
    const std::size_t end = text_.find('\n', at_);
    ended_ = end != std::string_view::npos;
    whole_line_ = text_.substr(at_, (ended_ ? end : text_.size()) - at_);
    if (whole_line_.ends_with('\r')) {
      whole_line_.remove_suffix(1);
    }
    line_ = trim(whole_line_);
    at_ = ended_ ? end + 1 : text_.size();
    ++number_;
    if (!line_.empty() && line_.front() != '#') {
      return true;
    }
  }
  line_ = {};
  whole_line_ = {};
  return false;
}

}  // namespace slamsensor::tools
