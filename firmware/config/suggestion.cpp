#include "firmware/config/suggestion.hpp"

#include "firmware/config/setting.hpp"

#include <algorithm>
#include <vector>

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kWordMax = 64;  // longer words are no slip of the hand, and the distance is quadratic

/// The nearest names, as long as they are few.
struct Nearest {
  std::vector<std::string_view> names;
  std::size_t distance = kWordMax;

  void offer(std::string_view candidate, std::size_t candidate_distance) {
    if (candidate_distance < distance) {
      names.clear();
      distance = candidate_distance;
    }
    if (candidate_distance == distance) {
      names.push_back(candidate);
    }
  }
  [[nodiscard]] std::string within(std::size_t limit) const {
    constexpr std::size_t kNamesMax = 4;
    std::string text;
    if (distance <= limit && names.size() <= kNamesMax) {
      for (std::size_t i = 0; i < names.size(); ++i) {
        text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + std::string(names[i]);
      }
    }
    return text;
  }
};

std::string lowered(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lower;
}

std::size_t limit_for(std::string_view word) {
  return std::max<std::size_t>(2, word.size() / 3);
}

/// How far `written` is from the key `key`. A key written without its unit ("tilt_min") is one step away.
std::size_t key_distance(std::string_view written, std::string_view key) {
  constexpr std::size_t kUnitMax = 6;  // "_deg_s"
  if (written.size() >= 3 && key.starts_with(written) && key.size() - written.size() <= kUnitMax &&
      key.substr(written.size()).starts_with('_')) {
    return 1;
  }
  return edit_distance(written, key);
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    last[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

std::string suggest_section(std::string_view path) {
  if (path.size() > kWordMax) {
    return {};
  }
  const std::string written = lowered(path);
  Nearest nearest;
  for (const Section& section : sections()) {
    nearest.offer(section.name, edit_distance(written, section.name));
  }
  return nearest.within(limit_for(path));
}

std::string suggest_key(std::string_view path) {
  if (path.size() > kWordMax) {
    return {};
  }
  const std::string written = lowered(path);
  const std::string_view whole = written;
  const std::size_t dot = whole.find('.');
  const std::string_view section = dot == std::string_view::npos ? std::string_view() : whole.substr(0, dot);
  const std::string_view key = dot == std::string_view::npos ? whole : whole.substr(dot + 1);
  Nearest nearest;
  for (const Setting& setting : settings()) {
    // A key of another section must fit better than one of the section that was written.
    const std::size_t elsewhere = setting.section() == section ? 0 : 1;
    nearest.offer(setting.path, key_distance(key, setting.key()) + elsewhere);
  }
  return nearest.within(limit_for(key));
}

}  // namespace slamsensor::firmware
