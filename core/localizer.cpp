#include "core/localizer.hpp"

#include "core/graph/lattice.hpp"

#include <algorithm>

namespace slamsensor::core {

bool Localizer::set_map(std::span<const Point2> map_W, std::span<const LandmarkSize> sizes) noexcept {
  const bool is_sound =
      std::all_of(map_W.begin(), map_W.end(), on_lattice) && atlas_.take_survey(map_W, sizes);
  if (!is_sound) {
    atlas_.reset();
  }
  atlas_.set_frozen(Frozen::Yes);
  return is_sound;
}

MapCheck Localizer::restore(const MapState& state) noexcept {
  const MapCheck check = atlas_.restore(state);
  atlas_.set_frozen(Frozen::Yes);
  return check;
}

}  // namespace slamsensor::core
