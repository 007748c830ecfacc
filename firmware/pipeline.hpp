#pragma once

#include "core/slam.hpp"
#include "firmware/arena_block.hpp"
#include "firmware/recording/event_log.hpp"
#include "firmware/scan/sensor_head.hpp"
#include "firmware/store/map_snapshot.hpp"

#include <optional>
#include <span>

namespace slamsensor::firmware {

/// The stations between the bytes of the devices and the fix (DESIGN 1), in the one block of memory that they
/// live in. The daemon, the replay of a recording and the tests run this same code; they differ in who steps
/// the head and who takes the fix. pipeline.cpp lists the stations in their order. One thread.
class Pipeline {
 public:
  /// Takes the memory that `config` asks for (ArenaBlock).
  explicit Pipeline(const core::Config& config) : slam_(config) {}

  /// Folds in what a sensor head did; a fix when that ends a scan. `utc_ahead` is by how much UTC is ahead of
  /// the stamps.
  [[nodiscard]] std::optional<core::Fix> take(const HeadEvent& event, hal::Stamp utc_ahead,
                                              const core::Deadline& deadline) noexcept;

  /// Localises one scan from its scanlines, each in the order of the sweep.
  template <typename Scanlines>
  [[nodiscard]] core::Fix process(const Scanlines& scanlines, const core::ScanTime& time,
                                  const core::Deadline& deadline) {
    for (const auto& scanline : scanlines) {
      slam_->add_scanline(scanline);
    }
    return slam_->finish_scan(time, deadline);
  }

  /// Localises one scan from landmarks that were found elsewhere, heaviest first, and seen in `view`.
  [[nodiscard]] core::Fix process_landmarks(std::span<const core::ScanLandmark> landmarks,
                                            const core::ScanView& view, const core::ScanTime& time,
                                            const core::Deadline& deadline) {
    return slam_->process(landmarks, view, time, deadline);
  }

  /// Does to the maps what `command` says; `state` is what a Restore goes on from, with `frozen` as it is
  /// marked: Yes freezes, No leaves the mode as it is; `room` is written over by DropRivals. The check is
  /// that of a Restore: with a flaw nothing was changed.
  core::MapCheck carry_out(MapCommand command, const core::MapState& state, core::Frozen frozen,
                           MapSnapshot& room) noexcept;

  /// To be looked at: maps, counters, landmarks of the last scan.
  [[nodiscard]] const core::Slam& slam() const { return *slam_; }

 private:
  void begin_from_home_map(MapSnapshot& room) noexcept;

  ArenaBlock<core::Slam> slam_;
};

}  // namespace slamsensor::firmware
