#include "tools/world/toml_file.hpp"

#include "firmware/config/load_config.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

namespace slamsensor::tools {
namespace {

/// "a", "b" or "c", each in quotes.
std::string list_of_words(const std::vector<std::string_view>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += i == 0 ? "" : i + 1 == words.size() ? " or " : ", ";
    text.append("\"").append(words[i]).append("\"");
  }
  return text;
}

}  // namespace

std::string text_of(double number) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof(buffer), number).ptr;
  return {buffer, end};
}

tl::expected<std::string, WorldError> read_text(const std::filesystem::path& path, std::string_view what) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return tl::unexpected(WorldError{path.string() + ": cannot be opened; give the path of a " +
                                     std::string(what) + " (TOML)"});
  }
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

tl::expected<toml::table, WorldError> parse_toml(std::string_view text, std::string_view name) {
  if (const auto line = firmware::too_deep_line(text)) {
    return tl::unexpected(WorldError{std::string(name) + ":" + std::to_string(*line) +
                                     ": a key has more parts than any setting; correct this line"});
  }
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    const toml::source_position where = error.source().begin;
    return tl::unexpected(WorldError{std::string(name) + ":" + std::to_string(where.line) + ":" +
                                     std::to_string(where.column) + ": " + std::string(error.description())});
  }
}

const toml::node* TomlTable::take(std::string_view key) {
  known_.emplace_back(key);
  return table_ != nullptr ? table_->get(key) : nullptr;
}

std::string TomlTable::full(std::string_view key) const {
  return (name_.empty() ? "" : name_ + ".") + std::string(key);
}

void TomlTable::check_range(std::string_view key, const toml::node* node, double number, double min,
                            double max) {
  const double slack =
      node == nullptr ? 1e-9 * std::abs(number) : 0.0;  // degrees that went to radians and back
  if (!(number >= min - slack && number <= max + slack)) {
    file_.refuse(node, full(key) + " = " + text_of(number) + " is out of range: " + text_of(min) + " to " +
                           text_of(max));
  }
}

TomlTable& TomlTable::number(std::string_view key, double& value, double min, double max, double scale) {
  const toml::node* const node = take(key);
  if (node != nullptr && !node->is_number()) {
    file_.refuse(node, std::string(key) + " is a number");
    return *this;
  }
  const double number = node != nullptr ? *node->value<double>() : value / scale;
  check_range(key, node, number, min, max);
  value = node != nullptr ? number * scale : value;
  return *this;
}

void TomlTable::whole(std::string_view key, std::uint64_t& value, double min, double max) {
  const toml::node* const node = take(key);
  if (node == nullptr) {
    check_range(key, node, static_cast<double>(value), min, max);
    return;
  }
  const std::optional<std::int64_t> number = node->is_integer() ? node->value<std::int64_t>() : std::nullopt;
  if (!number) {
    file_.refuse(node, std::string(key) + " is a whole number");
    return;
  }
  check_range(key, node, static_cast<double>(*number), min, max);
  value = static_cast<std::uint64_t>(*number);
}

TomlTable& TomlTable::text(std::string_view key, std::string& value) {
  if (const toml::node* const node = take(key)) {
    const std::optional<std::string> text = node->is_string() ? node->value<std::string>() : std::nullopt;
    if (!text) {
      file_.refuse(node, std::string(key) + " is a text in quotes");
    }
    value = text.value_or(value);
  }
  return *this;
}

std::size_t TomlTable::word(std::string_view key, const std::vector<std::string_view>& words,
                            std::size_t index) {
  const toml::node* const node = take(key);
  if (node == nullptr) {
    return index;
  }
  const auto found = std::find(words.begin(), words.end(), node->value_or(std::string_view{}));
  if (found == words.end()) {
    file_.refuse(node, std::string(key) + " is " + list_of_words(words));
    return index;
  }
  return static_cast<std::size_t>(found - words.begin());
}

TomlTable& TomlTable::interval(const std::string& name, const std::string& unit, Interval& value, double min,
                               double max) {
  number(name + "_min_" + unit, value.min, min, max);
  number(name + "_max_" + unit, value.max, min, max);
  if (value.min > value.max) {
    file_.refuse(table_, full(name) + ": the least, " + text_of(value.min) + ", exceeds the greatest, " +
                             text_of(value.max) + "; set both");
  }
  return *this;
}

TomlTable& TomlTable::needs(std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    if (table_ != nullptr && !table_->contains(key)) {
      refuse("needs the key '" + std::string(key) + "'");
    }
  }
  return *this;
}

void TomlTable::refuse(const std::string& what) {
  if (!what.empty()) {
    file_.refuse(table_, "[" + name_ + "] " + what);
  }
}

void TomlTable::finish() {
  if (table_ == nullptr) {
    return;
  }
  for (const auto& [key, node] : *table_) {
    if (std::find(known_.begin(), known_.end(), key.str()) == known_.end()) {
      file_.refuse_at(key.source(), "unknown key '" + std::string(key.str()) + "'" +
                                        (name_.empty() ? "" : " in [" + name_ + "]") +
                                        "; remove it or correct its spelling");
    }
  }
}

void TomlFile::refuse_at(const toml::source_region& where, const std::string& what) {
  if (!problem_) {
    problem_ = WorldError{name_ + ":" + std::to_string(where.begin.line) + ":" +
                          std::to_string(where.begin.column) + ": " + what};
  }
}

void TomlFile::refuse(const toml::node* node, const std::string& what) {
  if (node != nullptr) {
    refuse_at(node->source(), what);
  } else if (!problem_) {
    problem_ = WorldError{(name_.empty() ? "" : name_ + ": ") + what};
  }
}

const toml::table* TomlFile::as_table(const std::string& name, const toml::node& node) {
  if (!node.is_table()) {
    refuse(&node, name + " is a table: write [" + name + "]");
  }
  return node.as_table();
}

const toml::array* TomlFile::as_list(const std::string& name, const toml::node& node) {
  if (!node.is_array()) {
    refuse(&node, name + " is a list: write [[" + name + "]]");
  }
  return node.as_array();
}

std::optional<WorldError> TomlFile::finish() {
  top_.finish();
  return problem_;
}

}  // namespace slamsensor::tools
