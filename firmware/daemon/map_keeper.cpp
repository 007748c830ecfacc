#include "firmware/daemon/map_keeper.hpp"

#include "firmware/store/map_file.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace slamsensor::firmware {
namespace {

MapMethod method_of(const core::Config& config) {
  return {config.association.tolerance_m, config.detection.range_step_m, config.detection.bearing_step_rad,
          config.association.depth, config.detection.detected_most()};
}

std::int64_t seconds_of(std::chrono::nanoseconds utc) {
  return std::chrono::duration_cast<std::chrono::seconds>(utc).count();
}

tl::unexpected<ControlError> refusal_of(const StoreError& error) {
  switch (error.fault) {
    case StoreFault::Name:
      return refusal(ControlErrorCode::Value, error.message);
    case StoreFault::Missing:
      return refusal(ControlErrorCode::NotFound, error.message);
    case StoreFault::Refused:
    case StoreFault::InUse:
      return refusal(ControlErrorCode::Refused, error.message);
    case StoreFault::Busy:
      return refusal(ControlErrorCode::Busy, error.message);
    case StoreFault::Io:
      break;
  }
  return refusal(ControlErrorCode::Failed, error.message);
}

tl::unexpected<ControlError> refusal_as_busy() {
  return refusal(ControlErrorCode::Busy, "the map is being changed by another request; try again");
}

constexpr std::string_view kBeforeReset = "-before-reset";

std::string line_of(const MapListing& map, std::string_view in_use) {
  std::string line = map.name + (map.name == in_use ? " (in use): " : ": ");
  if (map.good_generations == 0) {
    line += map.is_too_large ? "too large for the configured capacities" : "no good file";
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

MapKeeper::MapKeeper(const Config& config, SensorThreads& threads, Log& log, hal::Stamp now)
    : config_(config),
      threads_(threads),
      log_(log),
      store_(config.daemon.map_store.directory, config.core.capacities),
      policy_(hal::from_seconds(config.daemon.map_store.autosave_s), now),
      name_(config.daemon.map_store.name),
      is_frozen_(config.daemon.map_store.frozen),
      is_frozen_set_(is_frozen_) {
  about_.name = name_;
}

void MapKeeper::load_at_start() {
  if (auto prepared = store_.prepare(); !prepared) {
    log_.error(prepared.error().message + "; running without saving until that is mended");
  }
  auto loaded = store_.load(name_);
  if (!loaded) {
    if (loaded.error().fault == StoreFault::Missing) {
      log_.notice("no map '" + name_ + "' yet: a new one begins with the first scan");
    } else {
      log_.error(loaded.error().message + "; starting without it");
    }
    return;
  }
  if (!loaded->warning.empty()) {
    log_.warning(loaded->warning);
  }
  static_cast<void>(give({MapCommand::Restore, 0, name_, std::move(*loaded)}));
}

bool MapKeeper::give(Pending pending) {
  if (pending_) {
    return false;
  }
  pending_ = std::move(pending);
  SlamOrder order;
  order.kind = pending_->kind;
  if (pending_->map) {
    order.state = pending_->map->file.state();
    order.frozen = pending_->map->file.about.frozen ? core::Frozen::Yes : core::Frozen::No;
  }
  const bool is_given = threads_.slam_orders().give(order);
  if (!is_given) {
    pending_.reset();
    return false;
  }
  threads_.wake_slam();
  return true;
}

ControlOutcome MapKeeper::ask(Pending pending) {
  if (!give(std::move(pending))) {
    return refusal_as_busy();
  }
  return std::nullopt;
}

std::vector<MapKeeper::Answer> MapKeeper::step(const OutputTime& now) {
  if (pending_ && !answer_) {
    answer_ = threads_.slam_orders().answer();
  }
  if (pending_ && answer_ && is_published(*answer_)) {
    finish_order(now.monotonic);
  }
  if (mode_wanted_ && !set_mode(0, *mode_wanted_, now)) {
    mode_wanted_.reset();  // given; else another order is under way
  }
  if (!is_frozen_ && !is_replacing() && policy_.is_due(revision(), now.monotonic)) {
    if (auto saved = store(name_, now); !saved) {
      log_.error(saved.error().message);
    }
  }
  return std::exchange(answers_, {});
}

/// Whether the status that others see is that after the order: who has its answer may rely on it.
bool MapKeeper::is_published(const SlamAnswer& answer) const {
  return threads_.publish().status().slam.map_revision >= answer.revision;
}

void MapKeeper::finish_order(hal::Stamp now) {
  const Pending pending = std::move(*std::exchange(pending_, std::nullopt));
  const SlamAnswer answer = *std::exchange(answer_, std::nullopt);
  if (tap_ && answer.check.ok()) {
    if (pending.map && pending.map->file.about.frozen) {
      tap_(MapCommand::Freeze, answer);
    }
    tap_(pending.kind, answer);
  }
  auto result = carried_out(pending, answer, now);
  if (pending.token != 0) {
    answers_.push_back({pending.token, std::move(result)});
  } else if (result) {
    log_.notice(result->summary);
  } else {
    log_.error(result.error().message);
  }
}

ControlResult MapKeeper::carried_out(const Pending& pending, const SlamAnswer& answer, hal::Stamp now) {
  switch (pending.kind) {
    case MapCommand::Restore: {
      const MapFile& file = pending.map->file;
      if (!answer.check.ok()) {
        return refusal(ControlErrorCode::Refused,
                       pending.map->path.string() + ": " +
                           flaw_text(answer.check, file.state(), config_.core.capacities));
      }
      forget_map(answer.revision);
      name_ = pending.name;
      about_ = file.about;
      about_.name = name_;
      saved_ = now;
      is_frozen_ = is_frozen_ || about_.frozen;
      return ControlReply{"map '" + name_ + "' loaded: " + std::to_string(file.landmarks.size()) +
                              " landmarks, saved " + utc_text(file.about.saved_utc_s) +
                              (about_.frozen ? "; it is marked frozen: map unfreeze lets it grow" : ""),
                          {}};
    }
    case MapCommand::Reset:
      forget_map(answer.revision);
      about_ = {};
      about_.name = name_;
      return ControlReply{"map forgotten; the next scan begins a new one", {}};
    case MapCommand::Freeze:
      is_frozen_ = true;
      return ControlReply{"map frozen", {}};
    case MapCommand::Unfreeze:
      is_frozen_ = false;
      about_.frozen = false;
      return ControlReply{"map grows again", {}};
    case MapCommand::DropRivals:
      break;
  }
  return refusal(ControlErrorCode::Failed, "unknown order");
}

void MapKeeper::forget_map(std::uint64_t revision) {
  valid_from_ = revision;
  policy_.saved(revision, hal::monotonic_now());
  ++replaced_;
}

/// Of the map that is there to be saved; that of an earlier map counts as saved.
std::uint64_t MapKeeper::revision() const {
  return std::max(valid_from_, threads_.map().revision());
}

bool MapKeeper::is_unsaved() const {
  return policy_.is_unsaved(revision());
}

/// From the order until its answer the SLAM thread may have the next map already, while name_ and about_ are
/// those of the last one.
bool MapKeeper::is_replacing() const {
  return pending_ && (pending_->kind == MapCommand::Restore || pending_->kind == MapCommand::Reset);
}

tl::expected<std::string, StoreError> MapKeeper::store(const std::string& name, const OutputTime& now) {
  if (is_replacing()) {
    return store_failure(StoreFault::Busy,
                         "map '" + name + "': not saved: a map load or reset is under way; try again");
  }
  MapAbout about = about_;
  about.name = name;
  about.method = method_of(config_.core);
  if (config_.datum) {
    about.datum = config_.datum;
  }
  std::uint64_t revision = 0;
  std::size_t landmarks = 0;
  // Others go without a copy until it is on the disk; neither the SLAM nor the publish thread waits for it.
  auto saved = threads_.map().read([&](const MapSnapshot& map) -> tl::expected<SavedMap, StoreError> {
    if (map.empty() || map.revision() < valid_from_) {
      return store_failure(StoreFault::Missing, "there is no map to save yet; make a scan first");
    }
    revision = map.revision();
    landmarks = map.state().landmarks.size();
    return store_.save(about, map.state(), seconds_of(now.utc));
  });
  if (!saved) {
    policy_.failed(now.monotonic);
    return tl::unexpected(saved.error());
  }
  for (const std::string& warning : saved->warnings) {
    log_.warning(warning);
  }
  if (name == name_) {
    about_ = saved->about;
    saved_ = now.monotonic;
    policy_.saved(revision, now.monotonic);
  }
  return "map '" + name + "' saved: " + std::to_string(landmarks) + " landmarks, " +
         std::to_string(saved->bytes) + " bytes";
}

void MapKeeper::save_now(const OutputTime& now) {
  if (is_frozen_ || !is_unsaved()) {
    return;
  }
  if (auto saved = store(name_, now)) {
    log_.notice(*saved);
  } else if (saved.error().fault == StoreFault::Missing || saved.error().fault == StoreFault::Busy) {
    log_.info(saved.error().message);
  } else {
    log_.error(saved.error().message);
  }
}

void MapKeeper::save_at_end(const OutputTime& now) {
  if (config_.daemon.map_store.autosave_s > 0.0) {
    save_now(now);
  }
}

void MapKeeper::on_new_config() {
  const MapStoreConfig& settings = config_.daemon.map_store;
  if (std::exchange(is_frozen_set_, settings.frozen) != settings.frozen) {
    mode_wanted_ = settings.frozen ? MapMode::Frozen : MapMode::Growing;
  }
  policy_.set_period(hal::from_seconds(settings.autosave_s));
}

std::vector<std::uint8_t> MapKeeper::encoded() {
  MapAbout about = about_;
  about.method = method_of(config_.core);
  return threads_.map().read([&](const MapSnapshot& map) {
    return map.empty() || map.revision() < valid_from_ ? std::vector<std::uint8_t>()
                                                       : encode_map(about, map.state());
  });
}

// Requests of the control socket.

ControlResult MapKeeper::list() {
  const auto maps = store_.list();
  if (!maps) {
    return refusal_of(maps.error());
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
  threads_.map().read([&](const MapSnapshot& map) {
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

ControlResult MapKeeper::landmarks() {
  ControlReply reply;
  reply.lines.emplace_back("id x_m y_m sigma_m diameter_m");
  threads_.map().read([&](const MapSnapshot& map) {
    const core::MapState& state = map.state();
    const std::size_t count = map.revision() >= valid_from_ ? state.landmarks.size() : 0;
    for (std::size_t i = 0; i < count; ++i) {
      const core::MapLandmark& landmark = state.landmarks[i];
      const core::Point2& place_W = state.positions_W[i];
      std::array<char, 128> line{};
      std::snprintf(line.data(), line.size(), "%u %.3f %.3f %.3f %.3f", landmark.id, place_W.x(), place_W.y(),
                    static_cast<double>(landmark.sigma_m), landmark.size.diameter_m());
      reply.lines.emplace_back(line.data());
    }
  });
  return reply;
}

ControlResult MapKeeper::save(std::string_view name, const OutputTime& now) {
  const std::string to(name.empty() ? name_ : name);
  if (is_frozen_ && to == name_) {
    return refusal(ControlErrorCode::Refused,
                   "the map is frozen: nothing in it has changed; save it under another name or unfreeze it");
  }
  auto saved = store(to, now);
  if (!saved) {
    return refusal_of(saved.error());
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
    return refusal_of(removed.error());
  }
  return ControlReply{"map '" + std::string(name) + "' removed", {}};
}

ControlOutcome MapKeeper::load(ControlToken token, std::string_view name) {
  auto loaded = store_.load(name.empty() ? name_ : name);
  if (!loaded) {
    return refusal_of(loaded.error());
  }
  if (!loaded->warning.empty()) {
    log_.warning(loaded->warning);
  }
  return ask({MapCommand::Restore, token, std::string(name.empty() ? name_ : name), std::move(*loaded)});
}

/// What the map was before stays under a name of its own: the next saves would replace both generations.
ControlOutcome MapKeeper::reset(ControlToken token, const OutputTime& now) {
  if (pending_) {
    return refusal_as_busy();
  }
  if (is_frozen_) {
    return refusal(ControlErrorCode::Refused, "the map is frozen; unfreeze it first");
  }
  const std::string before = name_.substr(0, kMapNameMax - kBeforeReset.size()) + std::string(kBeforeReset);
  const bool has_map = threads_.map().read(
      [&](const MapSnapshot& map) { return !map.empty() && map.revision() >= valid_from_; });
  if (has_map) {
    if (auto kept = store(before, now); !kept) {
      return refusal(ControlErrorCode::Failed, "the map cannot be kept as '" + before +
                                                   "' and is not forgotten: " + kept.error().message);
    }
  }
  return ask({MapCommand::Reset, token, name_, std::nullopt});
}

ControlOutcome MapKeeper::set_mode(ControlToken token, MapMode mode, const OutputTime& now) {
  if (pending_) {
    return refusal_as_busy();
  }
  if (mode == MapMode::Frozen && !is_frozen_ && is_unsaved()) {
    if (auto saved = store(name_, now); !saved) {
      log_.warning("the map is frozen with changes that are not saved: " + saved.error().message);
    }
  }
  return ask(
      {mode == MapMode::Frozen ? MapCommand::Freeze : MapCommand::Unfreeze, token, name_, std::nullopt});
}

}  // namespace slamsensor::firmware
