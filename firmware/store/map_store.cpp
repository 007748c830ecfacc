#include "firmware/store/map_store.hpp"

#include "firmware/store/map_file.hpp"
#include "firmware/store/map_names.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <map>
#include <new>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kBackOffMin = std::chrono::seconds(1);
constexpr hal::Stamp kBackOffMax = std::chrono::minutes(15);

using Path = std::filesystem::path;

constexpr std::size_t kKnownGoodMax = 16;

/// Second name of a good file on file systems that have hard links, its only name on others; there it is for
/// a moment only the previous generation, which a restart takes as well.
tl::expected<void, IoError> keep_as_previous(const MapPaths& paths) {
  if (::unlink(paths.keeping.c_str()) != 0 && errno != ENOENT) {
    return io_failure("unlink");
  }
  const bool is_linked = ::link(paths.current.c_str(), paths.keeping.c_str()) == 0;
  if (!is_linked && errno != EPERM && errno != EOPNOTSUPP && errno != ENOSYS && errno != EMLINK) {
    return io_failure("link");
  }
  const Path& from = is_linked ? paths.keeping : paths.current;
  if (::rename(from.c_str(), paths.previous.c_str()) != 0) {
    return io_failure("rename");
  }
  // Where the previous generation was this very file already, a rename does nothing.
  if (is_linked && ::unlink(paths.keeping.c_str()) != 0 && errno != ENOENT) {
    return io_failure("unlink");
  }
  return {};
}

}  // namespace

void AutosavePolicy::saved(std::uint64_t revision, hal::Stamp now) noexcept {
  saved_ = revision;
  back_off_ = hal::Stamp{};
  next_ = now + period_;
}

void AutosavePolicy::failed(hal::Stamp now) noexcept {
  const hal::Stamp wanted = back_off_ == hal::Stamp{} ? std::max(period_, kBackOffMin) : 2 * back_off_;
  back_off_ = std::min(wanted, std::max(period_, kBackOffMax));
  next_ = now + back_off_;
}

void AutosavePolicy::set_period(hal::Stamp period) noexcept {
  if (back_off_ == hal::Stamp{}) {
    next_ += period - period_;
  }
  period_ = period;
}

MapStore::MapStore(Path folder, const core::Capacities& capacities)
    : folder_(std::move(folder)), capacities_(capacities) {
}

tl::expected<void, StoreError> MapStore::prepare() {
  if (lock_) {
    return {};
  }
  std::error_code error;
  std::filesystem::create_directories(folder_, error);  // what is wrong shows in the next step
  auto lock = StoreLock::acquire(folder_);
  if (!lock && lock.error().error == EWOULDBLOCK) {
    return store_failure(StoreFault::InUse,
                         "map folder " + folder_.string() +
                             ": another process saves maps there; stop it, or give each daemon a "
                             "map.directory of its own");
  }
  if (!lock) {
    return store_failure(StoreFault::Io, "map folder " + folder_.string() +
                                             ": maps cannot be saved: .lock: " + lock.error().text());
  }
  lock_ = std::move(*lock);
  clean();
  return {};
}

void MapStore::clean() {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto name = parse_file_name(entry->path().filename().string());
    if (name && name->role == MapFileRole::Temporary) {
      ::unlink(entry->path().c_str());
    }
  }
}

MapStore::Inspection MapStore::inspect(const Path& path) const {
  Inspection found;
  const auto content = read_regular(path, kMapFileBytesMax, kMapMagic);
  if (!content) {
    found.is_missing = content.error().error == ENOENT;
    found.reason = path.string() + ": " + content.error().text();
    return found;
  }
  found.identity = content->identity;
  try {
    auto map = decode_map(content->bytes, capacities_);
    if (map) {
      found.map = std::move(*map);
    } else {
      found.is_too_large = map.error().problem == MapProblem::TooLarge;
      found.reason = path.string() + ": " + map.error().message;
    }
  } catch (const std::bad_alloc&) {
    found.reason = path.string() + ": there is not enough memory to load it; give the daemon more";
  }
  return found;
}

tl::expected<LoadedMap, StoreError> MapStore::load(std::string_view name) const {
  if (!is_map_name(name)) {
    return bad_map_name(name);
  }
  const MapPaths paths = paths_of(folder_, name);
  const std::string label = "map '" + std::string(name) + "': ";
  Inspection current = inspect(paths.current);
  if (current.map) {
    return LoadedMap{std::move(*current.map), paths.current, {}};
  }
  Inspection previous = inspect(paths.previous);
  if (previous.map) {
    return LoadedMap{
        std::move(*previous.map), paths.previous,
        label + "the previous generation " + paths.previous.string() + " is used: " + current.reason};
  }
  if (current.is_missing && previous.is_missing) {
    return store_failure(StoreFault::Missing, label + "there is none in " + folder_.string());
  }
  std::string reason = current.is_missing ? previous.reason : current.reason;
  if (!current.is_missing && !previous.is_missing) {
    reason += "; and the previous generation " + previous.reason;
  }
  return store_failure(StoreFault::Refused, label + "not loaded: " + reason);
}

bool MapStore::is_known_good(const Path& path) {
  const auto identity = identify(path);
  return identity && std::find(known_good_.begin(), known_good_.end(), *identity) != known_good_.end();
}

void MapStore::remember_good(const FileIdentity& identity) {
  if (known_good_.size() == kKnownGoodMax) {
    known_good_.erase(known_good_.begin());
  }
  known_good_.push_back(identity);
}

/// Whether there is a good map at `path`; what else was there has been set aside.
tl::expected<bool, IoError> MapStore::is_good_or_aside(const Path& path, const MapPaths& paths,
                                                       std::int64_t now_utc_s,
                                                       std::vector<std::string>& warnings) {
  if (is_known_good(path)) {
    return true;
  }
  const Inspection found = inspect(path);
  if (found.map) {
    remember_good(found.identity);
    return true;
  }
  if (found.is_missing) {
    return false;
  }
  const std::optional<Path> aside = free_bad_path(paths, now_utc_s);
  if (!aside) {
    return tl::unexpected(IoError{"there is no free name to set a bad file aside", 0,
                                  "remove the files *.slammap.bad-* that are not needed"});
  }
  if (::rename(path.c_str(), aside->c_str()) != 0) {
    return io_failure("rename");
  }
  warnings.push_back("set aside as " + aside->string() + ": " + found.reason);
  return false;
}

tl::expected<void, IoError> MapStore::make_way(const MapPaths& paths, std::int64_t now_utc_s,
                                               std::vector<std::string>& warnings) {
  const auto current = is_good_or_aside(paths.current, paths, now_utc_s, warnings);
  if (!current) {
    return tl::unexpected(current.error());
  }
  if (!*current) {
    return {};  // the previous generation stays what it is
  }
  if (const auto previous = is_good_or_aside(paths.previous, paths, now_utc_s, warnings); !previous) {
    return tl::unexpected(previous.error());
  }
  return keep_as_previous(paths);
}

tl::expected<void, IoError> MapStore::place(const MapPaths& paths, const std::vector<std::uint8_t>& bytes,
                                            std::int64_t now_utc_s, std::vector<std::string>& warnings) {
  const auto written = write_durably(paths.temporary, bytes);
  if (!written) {
    return tl::unexpected(written.error());
  }
  auto result = make_way(paths, now_utc_s, warnings);
  if (result && ::rename(paths.temporary.c_str(), paths.current.c_str()) != 0) {
    result = io_failure("rename");
  }
  if (!result) {
    ::unlink(paths.temporary.c_str());
    return result;
  }
  remember_good(*written);
  return sync_folder(folder_);
}

tl::expected<SavedMap, StoreError> MapStore::save(MapAbout about, const core::MapState& state,
                                                  std::int64_t now_utc_s) {
  if (!is_map_name(about.name)) {
    return bad_map_name(about.name);
  }
  const std::string label = "map '" + about.name + "': not saved: ";
  const core::Capacities unlimited = unlimited_capacities();
  if (const core::MapCheck check = core::check_map(state, unlimited); !check.ok()) {
    return store_failure(StoreFault::Refused, label + flaw_text(check, state, unlimited));
  }
  if (auto ready = prepare(); !ready) {
    return tl::unexpected(std::move(ready.error()));
  }
  about.created_utc_s = about.created_utc_s == 0 ? now_utc_s : about.created_utc_s;
  about.saved_utc_s = now_utc_s;
  ++about.saves;
  const std::vector<std::uint8_t> bytes = encode_map(about, state);
  const MapPaths paths = paths_of(folder_, about.name);
  SavedMap saved{std::move(about), bytes.size(), {}};
  if (const auto placed = place(paths, bytes, now_utc_s, saved.warnings); !placed) {
    return store_failure(StoreFault::Io, label + paths.current.string() + ": " + placed.error().text());
  }
  return saved;
}

tl::expected<std::vector<MapListing>, StoreError> MapStore::list() const {
  std::map<std::string, MapListing> maps;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto file = parse_file_name(entry->path().filename().string());
    if (file && file->role != MapFileRole::Temporary) {
      MapListing& listing = maps[file->name];
      listing.name = file->name;
      listing.set_aside += file->role == MapFileRole::SetAside ? 1 : 0;
    }
  }
  if (error) {
    return store_failure(StoreFault::Io, "map folder " + folder_.string() + ": cannot be read: " +
                                             error.message() + "; create it, or correct map.directory");
  }
  std::vector<MapListing> listings;
  for (auto& [name, listing] : maps) {
    const MapPaths paths = paths_of(folder_, name);
    for (const Path& path : {paths.current, paths.previous}) {
      const Inspection found = inspect(path);
      if (!found.map) {
        if (!found.is_missing) {
          listing.is_too_large = listing.is_too_large || found.is_too_large;
          listing.problems.push_back(found.reason);
        }
        continue;
      }
      if (++listing.good_generations == 1) {
        listing.bytes = static_cast<std::uint64_t>(found.identity.size);
        listing.landmarks = found.map->landmarks.size();
        listing.saved_utc_s = found.map->about.saved_utc_s;
      }
    }
    listings.push_back(std::move(listing));
  }
  return listings;
}

tl::expected<void, StoreError> MapStore::remove(std::string_view name) {
  const std::string label = "map " + printable_bytes(name) + ": ";
  if (!is_map_name(name)) {
    return bad_map_name(name);
  }
  if (auto ready = prepare(); !ready) {
    return ready;
  }
  const MapPaths paths = paths_of(folder_, name);
  bool was_there = false;
  for (const Path& path : {paths.previous, paths.current}) {  // the newest last, should it be cut short
    if (::unlink(path.c_str()) == 0) {
      was_there = true;
    } else if (errno != ENOENT) {
      return store_failure(StoreFault::Io, label + "not removed: " + path.string() + ": " +
                                               io_failure("unlink").value().text());
    }
  }
  if (!was_there) {
    return store_failure(StoreFault::Missing, label + "there is none in " + folder_.string());
  }
  if (const auto synced = sync_folder(folder_); !synced) {
    return store_failure(StoreFault::Io, label + "removed, but maybe not for good: " + folder_.string() +
                                             ": " + synced.error().text());
  }
  return {};
}

tl::expected<SavedMap, StoreError> MapStore::copy(std::string_view from, std::string_view to,
                                                  std::int64_t now_utc_s) {
  auto loaded = load(from);
  if (!loaded) {
    return tl::unexpected(std::move(loaded.error()));
  }
  if (is_map_name(to)) {
    const MapPaths paths = paths_of(folder_, to);
    for (const Path& path : {paths.current, paths.previous}) {
      if (identify(path)) {
        return store_failure(StoreFault::Name, "map " + printable_bytes(to) + ": " + path.string() +
                                                   " is there already; remove it or choose another name");
      }
    }
  }
  MapAbout about = loaded->file.about;
  about.name = to;
  return save(std::move(about), loaded->file.state(), now_utc_s);
}

}  // namespace slamsensor::firmware
