#pragma once

#include "core/fix.hpp"

#include <string_view>

namespace slamsensor::core {

/// The name of a status wherever it is written as text: `no_fix`, `ambiguous`, `fix`.
[[nodiscard]] constexpr std::string_view to_string(FixStatus status) noexcept {
  switch (status) {
    case FixStatus::NoFix:
      return "no_fix";
    case FixStatus::Ambiguous:
      return "ambiguous";
    case FixStatus::Fix:
      return "fix";
  }
  return "unknown";
}

/// The name of a reason wherever it is written as text; a fix has the reason `none`.
[[nodiscard]] constexpr std::string_view to_string(FixReason reason) noexcept {
  switch (reason) {
    case FixReason::None:
      return "none";
    case FixReason::TooFewLandmarks:
      return "too_few_landmarks";
    case FixReason::NoOverlap:
      return "no_overlap";
    case FixReason::Symmetric:
      return "symmetric";
    case FixReason::Copy:
      return "copy";
    case FixReason::LocalMap:
      return "local_map";
    case FixReason::Deadline:
      return "deadline";
    case FixReason::Stale:
      return "stale";
    case FixReason::Device:
      return "device";
    case FixReason::Moved:
      return "moved";
    case FixReason::Timing:
      return "timing";
    case FixReason::NoScan:
      return "no_scan";
  }
  return "unknown";
}

/// The name of how a search ended wherever it is written as text.
[[nodiscard]] constexpr std::string_view to_string(SearchEnd end) noexcept {
  switch (end) {
    case SearchEnd::NotStarted:
      return "not_started";
    case SearchEnd::Complete:
      return "complete";
    case SearchEnd::Share:
      return "share";
    case SearchEnd::Deadline:
      return "deadline";
  }
  return "unknown";
}

}  // namespace slamsensor::core
