// The store as a folder of maps: what is there, taking one away, copying one.
#include "firmware/store/map_store.hpp"
#include "firmware/store/map_text.hpp"

#include <cerrno>
#include <map>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace slamsensor::firmware {
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
