#pragma once

#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/detection/landmark_detector.hpp"
#include "core/fix.hpp"
#include "core/landmark.hpp"
#include "core/mapping/hypothesis_set.hpp"
#include "core/memory/arena.hpp"
#include "core/reading.hpp"

#include <span>

namespace slamsensor::core {

/// The whole method: scanlines in, fixes out. All its memory is taken from the arena at construction;
/// afterwards no call allocates, throws, locks or reads a clock. One thread.
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

  /// The same as finish_scan for a scan whose landmarks were found elsewhere, heaviest first.
  [[nodiscard]] Fix process(std::span<const ScanLandmark> landmarks, const ScanTime& time,
                            const Deadline& deadline) noexcept;

  /// The landmarks of the last finish_scan, heaviest first; valid until the next one.
  [[nodiscard]] std::span<const ScanLandmark> scan_landmarks() const noexcept { return scan_landmarks_; }

  [[nodiscard]] const LandmarkDetector& detector() const noexcept { return detector_; }
  [[nodiscard]] const HypothesisSet& hypotheses() const noexcept { return hypotheses_; }

  /// Forgets maps and paths; the next scan starts a new map, unless frozen.
  void reset() noexcept { hypotheses_.reset(); }

  /// Goes on from a map that was kept (HypothesisSet::restore): the next scan finds itself in it. Refused,
  /// with its flaw, and nothing changed, when it is none that this configuration could have made.
  [[nodiscard]] MapCheck restore(const MapState& state) noexcept { return hypotheses_.restore(state); }

  /// Goes on with the best hypothesis alone (HypothesisSet::drop_rivals).
  void drop_rivals() noexcept { hypotheses_.drop_rivals(); }

  /// Localise only, or map too (HypothesisSet::set_frozen).
  void set_frozen(Frozen frozen) noexcept { hypotheses_.set_frozen(frozen); }

 private:
  LandmarkDetector detector_;
  HypothesisSet hypotheses_;
  std::span<const ScanLandmark> scan_landmarks_;
};

/// The memory that Slam takes with `config`, line by line; `bytes` receives the size of the block to give it.
[[nodiscard]] Arena::Plan plan_memory(const Config& config, std::size_t& bytes) noexcept;

}  // namespace slamsensor::core
