// The requests of the control socket about maps.
#include "firmware/daemon/map_keeper.hpp"
#include "firmware/daemon/refusal.hpp"
#include "firmware/store/map_layout.hpp"

namespace slamsensor::firmware {
namespace {

constexpr std::string_view kBeforeReset = "-before-reset";

std::string line_of(const MapListing& map, std::string_view in_use) {
  std::string line = map.name + (map.name == in_use ? " (in use): " : ": ");
  if (map.good_generations == 0) {
    line += "no good file";
  } else {
    line += std::to_string(map.landmarks) + " landmarks, saved " + utc_text(map.saved_utc_s) + ", " +
            std::to_string(map.bytes) + " bytes, " + std::to_string(map.good_generations) + " generation" +
            (map.good_generations == 1 ? "" : "s");
  }
  if (map.set_aside > 0) {
    line += ", " + std::to_string(map.set_aside) + " set aside";
  }
  for (const std::string& problem : map.problems) {
    line += "\n  " + problem;
  }
  return line;
}

}  // namespace

ControlResult MapKeeper::list() {
  const auto maps = store_.list();
  if (!maps) {
    return refusal(maps.error());
  }
  ControlReply reply{std::to_string(maps->size()) + " maps in " + store_.folder().string(), {}};
  for (const MapListing& map : *maps) {
    reply.lines.push_back(line_of(map, name_));
  }
  return reply;
}

ControlResult MapKeeper::info() {
  ControlReply reply;
  reply.lines.push_back("name: " + name_);
  reply.lines.push_back("file: " + paths_of(store_.folder(), name_).current.string());
  reply.lines.push_back(std::string("mode: ") + (is_frozen_ ? "frozen" : "growing"));
  threads_.publish().with_map([&](const MapSnapshot& map) {
    const bool is_there = map.revision() >= valid_from_;
    reply.lines.push_back("landmarks: " + std::to_string(is_there ? map.state().landmarks.size() : 0));
    reply.lines.push_back("poses: " + std::to_string(is_there ? map.state().path.size() : 0));
  });
  const SlamStatus slam = threads_.publish().status().slam;
  reply.lines.push_back("local maps: " + std::to_string(slam.local_maps) + ", " +
                        std::to_string(slam.local_landmarks) +
                        " landmarks; not saved before their place in the map is known");
  reply.lines.push_back(std::string("unsaved changes: ") + (is_unsaved() ? "yes" : "no"));
  if (about_.saves > 0) {
    reply.lines.push_back("saved: " + utc_text(about_.saved_utc_s) + ", " + std::to_string(about_.saves) +
                          " times since " + utc_text(about_.created_utc_s));
  }
  return reply;
}

ControlResult MapKeeper::save(std::string_view name, hal::Stamp now, std::int64_t utc_s) {
  const std::string to(name.empty() ? name_ : name);
  if (is_frozen_ && to == name_) {
    return refusal(ControlErrorCode::Refused,
                   "the map is frozen: nothing in it has changed; save it under another name or unfreeze it");
  }
  auto saved = store(to, now, utc_s);
  if (!saved) {
    return refusal(saved.error());
  }
  return ControlReply{*saved, {}};
}

ControlResult MapKeeper::remove(std::string_view name) {
  if (name == name_) {
    return refusal(ControlErrorCode::Refused, "map '" + name_ +
                                                  "' is in use; load another one first, or map reset to "
                                                  "forget what is in it");
  }
  if (auto removed = store_.remove(name); !removed) {
    return refusal(removed.error());
  }
  return ControlReply{"map '" + std::string(name) + "' removed", {}};
}

ControlOutcome MapKeeper::load(ControlToken token, std::string_view name) {
  auto loaded = store_.load(name.empty() ? name_ : name);
  if (!loaded) {
    return refusal(loaded.error());
  }
  if (!loaded->warning.empty()) {
    log_.warning(loaded->warning);
  }
  return ask({SlamOrder::Kind::Restore, token, std::string(name.empty() ? name_ : name), std::move(*loaded)});
}

/// What the map was before stays under a name of its own: the next saves would replace both generations.
ControlOutcome MapKeeper::reset(ControlToken token, hal::Stamp now, std::int64_t utc_s) {
  if (is_frozen_) {
    return refusal(ControlErrorCode::Refused, "the map is frozen; unfreeze it first");
  }
  const std::string before = name_.substr(0, kMapNameMax - kBeforeReset.size()) + std::string(kBeforeReset);
  const bool has_map = threads_.publish().with_map(
      [&](const MapSnapshot& map) { return !map.empty() && map.revision() >= valid_from_; });
  if (has_map) {
    if (auto kept = store(before, now, utc_s); !kept) {
      return refusal(ControlErrorCode::Failed, "the map cannot be kept as '" + before +
                                                   "' and is not forgotten: " + kept.error().message);
    }
  }
  return ask({SlamOrder::Kind::Reset, token, name_, std::nullopt});
}

ControlOutcome MapKeeper::set_mode(ControlToken token, MapMode mode, hal::Stamp now, std::int64_t utc_s) {
  if (mode == MapMode::Frozen && !is_frozen_ && is_unsaved()) {
    if (auto saved = store(name_, now, utc_s); !saved) {
      log_.warning("the map is frozen with changes that are not saved: " + saved.error().message);
    }
  }
  return ask({mode == MapMode::Frozen ? SlamOrder::Kind::Freeze : SlamOrder::Kind::Unfreeze, token, name_,
              std::nullopt});
}

}  // namespace slamsensor::firmware
