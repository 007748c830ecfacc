#pragma once

#include "core/config.hpp"
#include "core/fix.hpp"
#include "core/reading.hpp"
#include "core/slam.hpp"
#include "tests/rt/walks.hpp"

#include <cstdint>
#include <ostream>
#include <vector>

namespace slamsensor::tests {

/// One scan of a walk, as landmarks or as scanlines.
struct WalkScan {
  static constexpr std::int64_t kNoDeadline = -1;

  std::vector<core::ScanLandmark> landmarks;
  std::vector<std::vector<core::Reading>> scanlines;  ///< instead of landmarks, when there are any
  std::int64_t looks = kNoDeadline;                   ///< the deadline expires at this look at the clock
  bool reset_before = false;
};

/// Scans that take the method through what it can meet, all made beforehand.
struct Walk {
  core::Config config;
  std::vector<WalkScan> scans;
  /// Fails unless what the walk is for did happen.
  void (*expect_events)(const Walk& walk, const core::Slam& slam,
                        const std::vector<core::Fix>& fixes) = nullptr;
};

struct NamedWalk {
  const char* name;
  Walk (*make)();  ///< equal walks each time
};

inline void PrintTo(const NamedWalk& walk, std::ostream* out) {
  *out << walk.name;
}

/// Takes `slam` along the walk; `fixes` has an element per scan.
void run(const Walk& walk, core::Slam& slam, std::vector<core::Fix>& fixes) noexcept;

[[nodiscard]] std::vector<NamedWalk> all_walks();

}  // namespace slamsensor::tests
