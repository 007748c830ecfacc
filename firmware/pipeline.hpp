#pragma once

#include "core/slam.hpp"
#include "firmware/arena_block.hpp"

#include <span>

namespace slamsensor::firmware {

/// The stations from readings to fix (DESIGN 1) with the one block of memory that they live in. The daemon,
/// the replay of a recording and the tests run this same code; they differ in who feeds it and who takes the
/// fix. One thread.
class Pipeline {
 public:
  /// Takes the memory that `config` asks for (ArenaBlock).
  explicit Pipeline(const core::Config& config) : slam_(config) {}

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

  [[nodiscard]] core::Slam& slam() { return *slam_.operator->(); }
  [[nodiscard]] const core::Slam& slam() const { return *slam_; }

 private:
  ArenaBlock<core::Slam> slam_;
};

}  // namespace slamsensor::firmware
