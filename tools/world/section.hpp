#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace slamsensor::tools {

/// A closed interval that sizes are drawn from, uniformly.
struct Interval {
  double min = 0.0;
  double max = 0.0;
};

/// Why a world, a path or a simulation was refused: what, where and what to do, in one line.
struct WorldError {
  std::string message;
};

/// A value that is one word out of a few; `set` takes the word's index.
struct Choice {
  std::vector<std::string_view> words;
  std::function<void(std::size_t)> set;
};

/// `words` in the order of the enumerators of `value`, which are 0, 1, 2, ...
template <typename Enum>
[[nodiscard]] Choice choice_of(Enum& value, std::vector<std::string_view> words) {
  return {std::move(words), [&value](std::size_t index) { value = static_cast<Enum>(index); }};
}

/// One key of a world or scenario file: where its value goes and what it may be. `scale` takes the file's
/// unit to ours.
struct Field {
  std::string key;
  std::variant<double*, std::uint32_t*, std::uint64_t*, std::string*, Choice> value;
  double min = 0.0;  ///< in the file's unit; numbers only
  double max = 0.0;
  double scale = 1.0;
};

/// The keys of one table; `intervals` are those whose least must not exceed their greatest.
struct Section {
  std::string name;  ///< empty for the top of the file
  std::vector<Field> fields;
  std::vector<std::pair<std::string, const Interval*>> intervals;
  std::vector<std::string> required = {};   ///< keys that the table must have
  std::function<std::string()> check = {};  ///< what is wrong with the whole table, if anything; may be empty
};

/// The number that `field` holds, in the file's unit; nothing for a text or a choice.
[[nodiscard]] std::optional<double> number_of(const Field& field) noexcept;

/// The shortest text that reads back as `number`.
[[nodiscard]] std::string text_of(double number);

/// "ground.amplitude_m = 70 is out of range: 0 to 50" and the like.
[[nodiscard]] std::string out_of_range(const Section& section, const Field& field, double number);

/// What is wrong with the values that `section` points to, if anything: out of range, an empty interval.
[[nodiscard]] std::optional<WorldError> find_problem(const Section& section);

}  // namespace slamsensor::tools
