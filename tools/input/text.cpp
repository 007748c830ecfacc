#include "tools/input/text.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <system_error>

namespace slamsensor::tools {

tl::unexpected<InputError> refuse(std::string_view name, std::string_view what) {
  std::string message(name);
  message.append(": ").append(what);
  return tl::unexpected<InputError>(InputError{std::move(message)});
}

tl::unexpected<InputError> refuse_line(std::string_view name, std::size_t line, std::string_view what) {
  return refuse(std::string(name) + ":" + std::to_string(line), what);
}

tl::expected<void, InputError> check_encoding(std::string_view start, std::string_view name) {
  constexpr std::size_t kLookedAtBytes = 64;  // UTF-16 without a mark has a zero in each pair of bytes
  const bool has_mark = start.starts_with("\xFF\xFE") || start.starts_with("\xFE\xFF");
  if (has_mark || start.substr(0, kLookedAtBytes).find('\0') != std::string_view::npos) {
    return refuse(name, "is text in UTF-16, or no text; save it as UTF-8");
  }
  return {};
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kShownMax = 40;
  std::string result = "'";
  for (const char c : text.substr(0, kShownMax)) {
    result += (c >= ' ' && c <= '~') ? c : '?';
  }
  result += text.size() > kShownMax ? "...'" : "'";
  return result;
}

std::string shown(double value) {
  std::array<char, 32> digits{};
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 6);
  return std::string(digits.data(), end.ptr);
}

tl::expected<std::string, InputError> read_file(const std::filesystem::path& path, std::size_t bytes_max) {
  const std::string name = path.string();
  std::error_code error;
  // A pipe or a terminal would block here, and a device may never end.
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    return refuse(name, "does not exist; check the path");
  }
  if (!std::filesystem::status_known(status)) {
    return refuse(name, "cannot be opened: " + error.message());
  }
  if (!std::filesystem::is_regular_file(status)) {
    return refuse(name, "is not a regular file; give the name of a file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) {
    return refuse(name, "its size cannot be read: " + error.message());
  }
  if (bytes_max >= kFileBytesMax && size > kFileBytesMax) {
    return refuse(name, "has " + std::to_string(size) + " bytes, at most " + std::to_string(kFileBytesMax) +
                            " are read; split it");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return refuse(name, std::string("cannot be opened: ") + std::strerror(errno));
  }
  std::string bytes(static_cast<std::size_t>(std::min<std::uintmax_t>(size, bytes_max)), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (file.bad()) {
    return refuse(name, std::string("cannot be read: ") + std::strerror(errno));
  }
  bytes.resize(static_cast<std::size_t>(file.gcount()));  // it may have been cut since its size was asked for
  return bytes;
}

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
