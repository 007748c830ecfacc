#pragma once

#include "tools/view/sensor_story.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace slamsensor::tools {

/// How far one page has read a story; default: nothing yet.
struct StoryCursor {
  std::uint64_t path = 0;
  std::uint64_t path_epoch = ~std::uint64_t{0};
  std::uint64_t events = 0;
  std::optional<std::uint64_t> map_version;
  std::map<std::string, std::string> told;  ///< member of the object: its last value, as text
};

/// What the page shows at `now_us`, as one JSON object: members that have changed since `cursor`, which moves
/// on; of path and events what is new; of the map the chunks that are other ones. Lengths m, angles rad,
/// times s.
[[nodiscard]] nlohmann::json story_json(const SensorStory& story, std::int64_t now_us, StoryCursor& cursor);

/// Of events: [{"t": s since 1970, "tone", "text"}].
[[nodiscard]] nlohmann::json event_json(const StoryEvent& event);

}  // namespace slamsensor::tools
