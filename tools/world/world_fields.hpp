#pragma once

#include "tools/world/world_config.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace slamsensor::tools {

/// One key of a world file: where its value goes and what it may be. `scale` takes the file's unit to ours.
struct Field {
  std::string key;
  std::variant<double*, std::uint32_t*, std::uint64_t*, std::string*, MoverKind*> value;
  double min = 0.0;  ///< in the file's unit; numbers only
  double max = 0.0;
  double scale = 1.0;
};

/// The keys of one table; `intervals` are those whose least must not exceed their greatest.
struct Section {
  std::string name;  ///< empty for the top of the file
  std::vector<Field> fields;
  std::vector<std::pair<std::string, const Interval*>> intervals;
};

/// Every table of a world file that appears at most once. The pointers are into `config`.
[[nodiscard]] std::vector<Section> sections_of(WorldConfig& config);

/// The keys of one [[wall]], [[mover]], [[stand]].
[[nodiscard]] Section section_of(WallConfig& wall);
[[nodiscard]] Section section_of(MoverConfig& mover);
[[nodiscard]] Section section_of(StandConfig& stand);

/// The number that `field` holds, in the file's unit; nothing for a text.
[[nodiscard]] std::optional<double> number_of(const Field& field) noexcept;

/// "ground.amplitude_m = 70 is out of range: 0 to 50" and the like.
[[nodiscard]] std::string out_of_range(const Section& section, const Field& field, double number);

/// What is wrong with `config`, if anything: a value out of its range, an empty interval or area, too many
/// objects.
[[nodiscard]] std::optional<WorldError> find_problem(const WorldConfig& config);

}  // namespace slamsensor::tools
