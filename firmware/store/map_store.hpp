#pragma once

#include "firmware/store/map_file.hpp"
#include "firmware/store/map_names.hpp"
#include "firmware/store/store_io.hpp"
#include "hal/stamp.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// Says when a map that has changed is to be saved. Time is an argument.
class AutosavePolicy {
 public:
  /// `period` between two saves; 0: none is ever due. `now` is the start.
  AutosavePolicy(hal::Stamp period, hal::Stamp now) noexcept : period_(period), next_(now + period) {}

  /// What stands in the store is `revision` (Slam::revision): it was loaded, or saved by whomever.
  void saved(std::uint64_t revision, hal::Stamp now) noexcept;

  /// A save was tried and failed: the next is due after twice the time of the last, at first after the period
  /// or a second, whichever is longer, at last every 15 minutes or the period, whichever is longer.
  void failed(hal::Stamp now) noexcept;

  /// Takes effect from the last save on, and at once when a shorter period is over.
  void set_period(hal::Stamp period) noexcept;

  /// Whether `revision` is not in the store.
  [[nodiscard]] bool is_unsaved(std::uint64_t revision) const noexcept { return revision != saved_; }

  /// Whether `revision` is to be saved now.
  [[nodiscard]] bool is_due(std::uint64_t revision, hal::Stamp now) const noexcept {
    return period_ > hal::Stamp{} && is_unsaved(revision) && now >= next_;
  }

 private:
  hal::Stamp period_;
  hal::Stamp next_;        // no save is due before
  hal::Stamp back_off_{};  // after the last failure; 0: the last save did not fail
  std::uint64_t saved_ = 0;
};

struct LoadedMap {
  MapFile file;
  std::filesystem::path path;  ///< where it was read from
  std::string warning;         ///< why it is not the newest generation, in one line; empty when it is
};

struct SavedMap {
  MapAbout about;  ///< as the file has it; for the next save
  std::size_t bytes = 0;
  std::vector<std::string> warnings;  ///< files that were no good maps and were set aside, a line each
};

/// A named map of the store.
struct MapListing {
  std::string name;
  std::uint32_t good_generations = 0;  ///< 0 to 2
  std::uint32_t set_aside = 0;         ///< files NAME.slammap.bad-*
  std::uint64_t bytes = 0;             ///< of the newest good generation, as are the next two
  std::uint64_t landmarks = 0;
  std::int64_t saved_utc_s = 0;
  bool is_too_large = false;          ///< a generation is good, but not within the capacities
  std::vector<std::string> problems;  ///< why a generation cannot be loaded, a line each
};

/// Named maps in one folder, each a file and the generation before it. Whenever and however the process ends,
/// a map that was there is there: a save writes beside it, brings the bytes to the disk, and only then takes
/// the name over. A file that is not a good map is never overwritten: the save sets it aside first. One
/// thread, which may block.
class MapStore {
 public:
  /// Touches nothing yet. Maps beyond `capacities` are refused.
  MapStore(std::filesystem::path folder, const core::Capacities& capacities);

  /// The folder exists, is this process's alone, and unfinished saves of earlier ones are gone. Until it
  /// succeeds maps can be loaded and listed; whatever writes tries it again.
  [[nodiscard]] tl::expected<void, StoreError> prepare();

  /// The newest good generation of a map.
  [[nodiscard]] tl::expected<LoadedMap, StoreError> load(std::string_view name) const;

  /// `about.name` is the map `state` from now on, also after a power loss, and what it was before is its
  /// previous generation. Of `about`, created (when 0), saved and saves are filled in. After an error the
  /// map is as it was, or, should it be the very last step that failed, the new one, but maybe not for good.
  [[nodiscard]] tl::expected<SavedMap, StoreError> save(MapAbout about, const core::MapState& state,
                                                        std::int64_t now_utc_s);

  /// All maps by name, each generation read and checked. An error when the folder cannot be read.
  [[nodiscard]] tl::expected<std::vector<MapListing>, StoreError> list() const;

  /// No generation of the map is there any more; files that were set aside stay.
  [[nodiscard]] tl::expected<void, StoreError> remove(std::string_view name);

  /// `to`, which must not exist, is the newest good generation of `from`.
  [[nodiscard]] tl::expected<SavedMap, StoreError> copy(std::string_view from, std::string_view to,
                                                        std::int64_t now_utc_s);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  using Path = std::filesystem::path;

  /// What a file of the store turned out to be.
  struct Inspection {
    std::optional<MapFile> map;
    FileIdentity identity;
    bool is_missing = false;
    bool is_too_large = false;  ///< good, but not within the capacities
    std::string reason;         ///< why there is no map: path and what is wrong
  };

  [[nodiscard]] Inspection inspect(const Path& path) const;
  [[nodiscard]] bool is_known_good(const Path& path);
  void remember_good(const FileIdentity& identity);
  /// Makes room for the next generation: the good one there gets its second name, what is not good is set
  /// aside.
  [[nodiscard]] tl::expected<void, IoError> make_way(const MapPaths& paths, std::int64_t now_utc_s,
                                                     std::vector<std::string>& warnings);
  [[nodiscard]] tl::expected<bool, IoError> is_good_or_aside(const Path& path, const MapPaths& paths,
                                                             std::int64_t now_utc_s,
                                                             std::vector<std::string>& warnings);
  void clean();
  [[nodiscard]] tl::expected<void, IoError> place(const MapPaths& paths,
                                                  const std::vector<std::uint8_t>& bytes,
                                                  std::int64_t now_utc_s, std::vector<std::string>& warnings);

  Path folder_;
  core::Capacities capacities_;
  std::optional<StoreLock> lock_;
  std::vector<FileIdentity> known_good_;  // files that were found to be good maps and have not changed since
};

}  // namespace slamsensor::firmware
