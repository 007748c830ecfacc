#include "firmware/config/load_config.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kKeyPartsMax = 64;

/// Walks a TOML text without parsing it: strings and comments are passed over as a whole.
class TomlWalk {
 public:
  explicit TomlWalk(std::string_view text) : rest_(text) {}

  /// The next character outside of strings and comments; nothing at the end.
  std::optional<char> next() {
    while (!rest_.empty()) {
      const char c = rest_.front();
      if (c == '#') {
        pass(std::min(rest_.find('\n'), rest_.size()));
      } else if (c == '"' || c == '\'') {
        pass_string(c);
      } else {
        pass(1);
        return c;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::uint32_t line() const { return line_; }

 private:
  void pass(std::size_t count) {
    line_ += static_cast<std::uint32_t>(
        std::count(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(count), '\n'));
    rest_.remove_prefix(count);
  }

  /// A string of one line ends with its line at the latest, one in three quotes with three quotes.
  void pass_string(char quote) {
    const std::string three(3, quote);
    const bool is_long = rest_.starts_with(three);
    const std::string_view end = is_long ? std::string_view(three) : std::string_view(three).substr(0, 1);
    pass(end.size());
    while (!rest_.empty() && !rest_.starts_with(end) && (is_long || rest_.front() != '\n')) {
      const bool is_escape = quote == '"' && rest_.front() == '\\' && rest_.size() > 1;
      pass(is_escape ? 2 : 1);
    }
    if (rest_.starts_with(end)) {
      pass(end.size());
    }
  }

  std::string_view rest_;
  std::uint32_t line_ = 1;
};

}  // namespace

std::optional<std::uint32_t> too_deep_line(std::string_view text) {
  constexpr std::string_view kEndsKey = "=,[]{}\n";
  TomlWalk walk(text);
  std::size_t parts = 1;
  while (const auto c = walk.next()) {
    parts = kEndsKey.find(*c) != std::string_view::npos ? 1 : parts + (*c == '.' ? 1 : 0);
    if (parts > kKeyPartsMax) {
      return walk.line();
    }
  }
  return std::nullopt;
}

}  // namespace slamsensor::firmware
