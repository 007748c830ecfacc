#pragma once

#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>
#include <toml++/toml.h>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slamsensor::tools {

class TomlFile;

/// One table of a world or scenario file on its way into a struct. Each call reads one key, when the table
/// has it, and checks the value, read or not, against what it may be.
class TomlTable {
 public:
  /// `table` is null when there is none: values are only checked. `name` is empty for the top of the file.
  TomlTable(TomlFile& file, std::string name, const toml::table* table)
      : file_(file), name_(std::move(name)), table_(table) {}

  /// A number from `min` to `max` in the file's unit; `scale` takes it to ours.
  TomlTable& number(std::string_view key, double& value, double min, double max, double scale = 1.0);

  /// A whole number.
  template <std::unsigned_integral Count>
  TomlTable& count(std::string_view key, Count& value, double min, double max) {
    std::uint64_t wide = value;
    whole(key, wide, min, max);
    value = static_cast<Count>(wide);
    return *this;
  }

  TomlTable& text(std::string_view key, std::string& value);

  /// One of `words`, which stand in the order of the enumerators 0, 1, 2, ...
  template <typename Enum>
  TomlTable& choice(std::string_view key, Enum& value, const std::vector<std::string_view>& words) {
    value = static_cast<Enum>(word(key, words, static_cast<std::size_t>(value)));
    return *this;
  }

  /// The keys `<name>_min_<unit>` and `<name>_max_<unit>`.
  TomlTable& interval(const std::string& name, const std::string& unit, Interval& value, double min,
                      double max);

  /// The table must have each of `keys`.
  TomlTable& needs(std::initializer_list<std::string_view> keys);

  /// Refuses the table as a whole, unless `what` is empty.
  void refuse(const std::string& what);

  /// Marks `key` as known.
  const toml::node* take(std::string_view key);

  /// Refuses the first key that no call has asked for.
  void finish();

 private:
  void whole(std::string_view key, std::uint64_t& value, double min, double max);
  [[nodiscard]] std::size_t word(std::string_view key, const std::vector<std::string_view>& words,
                                 std::size_t index);
  void check_range(std::string_view key, const toml::node* node, double number, double min, double max);
  [[nodiscard]] std::string full(std::string_view key) const;

  TomlFile& file_;
  std::string name_;
  const toml::table* table_;
  std::vector<std::string> known_;
};

/// A world or scenario file while it is read. It keeps the first thing that is not right: an unknown key, a
/// wrong type, a value out of its range, each as `name:line:column: what`.
class TomlFile {
 public:
  /// Reads nothing and only checks the values.
  TomlFile() : top_(*this, "", nullptr) {}

  /// `name` stands for the file in messages.
  TomlFile(const toml::table& root, std::string_view name)
      : name_(name), root_(&root), top_(*this, "", &root) {}

  TomlFile(const TomlFile&) = delete;
  TomlFile& operator=(const TomlFile&) = delete;

  /// The keys that stand before all tables.
  [[nodiscard]] TomlTable& top() noexcept { return top_; }

  /// Reads the table [name] by `read(TomlTable&, value)`.
  template <typename Value, typename Read>
  void table(const std::string& name, Value& value, Read read) {
    const toml::node* const node = top_.take(name);
    TomlTable table(*this, name, node != nullptr ? as_table(name, *node) : nullptr);
    read(table, value);
    table.finish();
  }

  /// Reads each of the tables [[name]] into a new item of `items`; without a file it checks the items there
  /// are.
  template <typename Item, typename Read>
  void list(const std::string& name, std::vector<Item>& items, Read read) {
    const toml::node* const node = top_.take(name);
    const toml::array* const tables = node != nullptr ? as_list(name, *node) : nullptr;
    if (root_ != nullptr) {
      items.resize(tables != nullptr ? tables->size() : 0);
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
      TomlTable table(*this, name, tables != nullptr ? as_table(name, *tables->get(i)) : nullptr);
      read(table, items[i]);
      table.finish();
    }
  }

  /// Notes a mistake at `node`, which may be null, unless one was noted before.
  void refuse(const toml::node* node, const std::string& what);
  void refuse_at(const toml::source_region& where, const std::string& what);

  /// The first thing that is not right; after the last call of the above.
  [[nodiscard]] std::optional<WorldError> finish();

 private:
  const toml::table* as_table(const std::string& name, const toml::node& node);
  const toml::array* as_list(const std::string& name, const toml::node& node);

  std::string name_;
  const toml::table* root_ = nullptr;
  std::optional<WorldError> problem_;
  TomlTable top_;
};

/// The shortest text that reads back as `number`.
[[nodiscard]] std::string text_of(double number);

/// The whole of the file `path`, or that it cannot be opened; `what` names its kind ("world file").
[[nodiscard]] tl::expected<std::string, WorldError> read_text(const std::filesystem::path& path,
                                                              std::string_view what);

/// `text` as TOML, or its first mistake with line and column; `name` stands for the file in messages.
[[nodiscard]] tl::expected<toml::table, WorldError> parse_toml(std::string_view text, std::string_view name);

/// The keys of a [[stand]] of a world or scenario.
void read_stand(TomlTable& table, StandConfig& stand);

}  // namespace slamsensor::tools
