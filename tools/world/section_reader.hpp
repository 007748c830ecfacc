#pragma once

#include "tools/world/section.hpp"

#include <tl/expected.hpp>
#include <toml++/toml.h>

#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// The whole of the file `path`, or that it cannot be opened; `what` names its kind ("world file").
[[nodiscard]] tl::expected<std::string, WorldError> read_text(const std::filesystem::path& path,
                                                              std::string_view what);

/// `text` as TOML, or its first mistake with line and column; `name` stands for the file in messages.
[[nodiscard]] tl::expected<toml::table, WorldError> parse_toml(std::string_view text, std::string_view name);

/// Takes a parsed TOML file apart, table by table, and keeps the first thing that is not right: an unknown
/// key, a wrong type, a value out of its range, each as `name:line:column: what`.
class SectionReader {
 public:
  explicit SectionReader(std::string_view name) : name_(name) {}

  /// The first thing that was not right.
  [[nodiscard]] const std::optional<WorldError>& problem() const noexcept { return problem_; }

  void refuse(const toml::source_region& where, const std::string& what);
  void refuse_unknown(const toml::key& key);

  /// Reads `node` when `key` is a table of `sections` or a key of the one without a name; false when it is
  /// neither.
  bool read_known(const std::vector<Section>& sections, std::string_view key, const toml::node& node);

  /// Reads the tables [[name]] into `items` when `key` is `name`; `keys_of(Item&)` is the Section of one.
  template <typename Item, typename KeysOf>
  bool read_list(std::string_view name, std::string_view key, const toml::node& node,
                 std::vector<Item>& items, KeysOf keys_of) {
    if (key != name) {
      return false;
    }
    const toml::array* const list = list_of(name, node);
    for (std::size_t i = 0; list != nullptr && i < list->size() && !problem_; ++i) {
      read_section(keys_of(items.emplace_back()), *list->get(i));
    }
    return true;
  }

 private:
  const toml::array* list_of(std::string_view name, const toml::node& node);
  void read_section(const Section& section, const toml::node& node);
  void check_section(const Section& section, const toml::table& table);
  void read_field(const Section& section, const Field& field, const toml::node& node);
  bool in_range(const Section& section, const Field& field, const toml::node& node, double number);
  void read_value(const Section& section, const Field& field, const toml::node& node, double& value);
  template <std::unsigned_integral Count>
  void read_value(const Section& section, const Field& field, const toml::node& node, Count& value);
  void read_value(const Section& section, const Field& field, const toml::node& node, std::string& value);
  void read_choice(const Field& field, const toml::node& node, const Choice& choice);

  std::string name_;
  std::optional<WorldError> problem_;
};

}  // namespace slamsensor::tools
