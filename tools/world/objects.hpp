#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slamsensor::tools {

/// What a ray can meet.
enum class Surface : std::uint8_t { None, Ground, Stem, Crown, Bush, Rock, Post, Person, Car, Wall };

/// "tree", "bush", "rock", "post", ... as written to stems.csv.
[[nodiscard]] constexpr std::string_view name_of(Surface surface) noexcept {
  constexpr std::string_view kNames[] = {"none", "ground", "tree",   "crown", "bush",
                                         "rock", "post",   "person", "car",   "wall"};
  return kNames[static_cast<std::size_t>(surface)];
}

/// A thing that stands at one place for good: Stem (with its crown), Bush, Rock or Post. Frame W.
struct Object {
  Surface kind = Surface::Stem;
  double x_m = 0.0;
  double y_m = 0.0;
  double ground_m = 0.0;  ///< height of the ground at (x, y)
  double radius_m = 0.0;  ///< of the footprint: the stem, not the crown
  double height_m = 0.0;  ///< above the ground
  double crown_radius_m = 0.0;
  double crown_base_m = 0.0;  ///< above the ground
};

}  // namespace slamsensor::tools
