#pragma once

#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/decision/scan_view.hpp"
#include "core/detection/landmark_detector.hpp"
#include "core/fix.hpp"
#include "core/mapping/atlas.hpp"
#include "core/mapping/hypothesis_set.hpp"
#include "core/memory/arena.hpp"
#include "core/reading.hpp"

#include <optional>
#include <span>

namespace slamsensor::core {

/// How the maps stand, for those who show it.
struct MapsSummary {
  std::uint32_t home_landmarks = 0;
  std::uint32_t hypotheses =
      0;  ///< the paper's rule: kept ones; else the home map and the places of local maps
  std::uint32_t local_maps = 0;  ///< not tied to the home map
  std::uint32_t local_landmarks = 0;
};

/// The whole method: scanlines in, fixes out. What is believed is decided by the evidence (Atlas) or, where
/// acceptance.rule is Paper, by the paper's literal rule (HypothesisSet). All memory is taken from the arena
/// at construction; afterwards no call allocates, throws, locks or reads a clock. One thread.
class Slam {
 public:
  Slam(Arena& arena, const Config& config) noexcept;

  /// Folds one scanline (readings that share a tilt, in the order of the sweep) into the scan that is being
  /// made.
  void add_scanline(std::span<const Reading> scanline) noexcept;

  /// Ends the scan: detects its landmarks, finds its pose, brings it into the maps. The next scanline starts
  /// a new scan.
  [[nodiscard]] Fix finish_scan(const ScanTime& time, const Deadline& deadline) noexcept;

  /// Forgets the scanlines since the last scan: that scan was given up.
  void drop_scan() noexcept {
    static_cast<void>(detector_.finish());
    scan_landmarks_ = {};
  }

  /// The same as finish_scan for a scan whose landmarks were found elsewhere, heaviest first, and seen in
  /// `view`.
  [[nodiscard]] Fix process(std::span<const ScanLandmark> landmarks, const ScanView& view,
                            const ScanTime& time, const Deadline& deadline) noexcept;

  /// The landmarks of the last finish_scan, heaviest first; valid until the next one.
  [[nodiscard]] std::span<const ScanLandmark> scan_landmarks() const noexcept { return scan_landmarks_; }

  [[nodiscard]] const LandmarkDetector& detector() const noexcept { return detector_; }
  /// Null where the paper's rule is chosen.
  [[nodiscard]] const Atlas* atlas() const noexcept { return atlas_ ? &*atlas_ : nullptr; }

  /// Forgets maps and paths; the next scan starts a new map, unless frozen.
  void reset() noexcept;

  /// Replaces all maps by the one that `state` was taken of; scans go on being counted from there, and the
  /// next one finds itself in it. Refused, with its flaw, and nothing changed, when it is none that this
  /// configuration could have made.
  [[nodiscard]] MapCheck restore(const MapState& state) noexcept;

  /// Goes on with the best hypothesis alone, as if it had been restored.
  void drop_rivals() noexcept;

  /// Localise only, or map too: a frozen map never changes, and none is started.
  void set_frozen(Frozen frozen) noexcept;
  [[nodiscard]] Frozen frozen() const noexcept { return atlas_ ? atlas_->frozen() : paper_->frozen(); }

  /// The home map as it stands, copied into `room`, whose spans are as long as the capacities. Takes time in
  /// proportion to the map.
  [[nodiscard]] MapState copy_map(const MapRoom& room) const noexcept;
  /// Grows whenever the home map changes, and never falls.
  [[nodiscard]] std::uint64_t revision() const noexcept {
    return atlas_ ? atlas_->revision() : paper_->revision();
  }
  [[nodiscard]] const Counters& counters() const noexcept {
    return atlas_ ? atlas_->counters() : paper_->counters();
  }
  [[nodiscard]] MapsSummary maps() const noexcept;

 private:
  LandmarkDetector detector_;
  std::optional<HypothesisSet> paper_;
  std::optional<Atlas> atlas_;
  std::span<const ScanLandmark> scan_landmarks_;
};

/// The memory that Slam takes with `config`, line by line; `bytes` receives the size of the block to give it.
[[nodiscard]] Arena::Plan plan_memory(const Config& config, std::size_t& bytes) noexcept;

}  // namespace slamsensor::core
