#pragma once

#include "tools/view/sensor_story.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>

namespace slamsensor::tools {

/// How far one page has read a story; default: nothing yet.
struct StoryCursor {
  std::uint64_t path = 0;
  std::uint64_t path_epoch = ~std::uint64_t{0};
  std::uint64_t events = 0;
  std::uint64_t map_version = ~std::uint64_t{0};
};

/// What the page shows at `now_us`, as one JSON object; of path and events what is new to `cursor`, which
/// moves on, and of the map all when it has another version. Lengths m, angles rad, times s.
[[nodiscard]] nlohmann::json story_json(const SensorStory& story, std::int64_t now_us, StoryCursor& cursor);

/// Of events: [{"t": s since 1970, "tone", "text"}].
[[nodiscard]] nlohmann::json event_json(const StoryEvent& event);

}  // namespace slamsensor::tools
