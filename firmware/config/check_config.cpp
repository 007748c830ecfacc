#include "firmware/config/load_config.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr double kGridCellsMax = 2e7;  // the paper's grid has 420,600 cells

double grid_columns(const core::DetectionConfig& detection) {
  return std::ceil(2.0 * std::numbers::pi / detection.bearing_step_rad);
}

double grid_cells(const core::DetectionConfig& detection) {
  return std::ceil(detection.range_max_m / detection.range_step_m) * grid_columns(detection);
}

/// Edges that a map of `landmarks` needs at `depth`: a triangular lattice has 3 depth (depth + 1) / 2 for a
/// landmark, and 1000 random points have 9784 at depth 2 (DESIGN 2.3), a tenth more than the lattice.
double edges_needed(double landmarks, double depth) {
  return std::ceil(
      std::min(1.1 * 1.5 * depth * (depth + 1.0) * landmarks, 0.5 * landmarks * (landmarks - 1.0)));
}

/// Collects the broken rules. A rule names its keys, first the one whose value is called wrong.
class Rules {
 public:
  Rules(const LoadedConfig& loaded, const std::vector<ConfigError>& known) : loaded_(loaded), known_(known) {}

  /// `what` stands in the message between the value of the first key and those of the others.
  void require(bool holds, std::initializer_list<std::string_view> keys, const std::string& what) {
    if (holds || std::any_of(keys.begin(), keys.end(), [&](std::string_view key) { return is_known(key); })) {
      return;
    }
    Origin place;
    std::string others;
    for (const std::string_view key : keys) {
      const Origin& origin = loaded_.origin(key);
      place = place.is_default() ? origin : place;
      if (key != *keys.begin()) {
        others += (others.empty() ? "" : ", ") + std::string(key) + " = " + value(key) + " (" +
                  origin.short_text() + ')';
      }
    }
    const std::string_view first = *keys.begin();
    errors_.push_back({place, std::string(first),
                       "value " + value(first) + ' ' + what + ' ' + others + "; change one of them"});
  }

  std::vector<ConfigError> take_errors() { return std::move(errors_); }

 private:
  [[nodiscard]] bool is_known(std::string_view key) const {
    return std::any_of(known_.begin(), known_.end(),
                       [&](const ConfigError& error) { return error.key == key; });
  }
  [[nodiscard]] std::string value(std::string_view key) const {
    const Setting& setting = settings()[find_setting(key).value()];
    return value_text(setting, loaded_.config).value_or("none");
  }

  const LoadedConfig& loaded_;
  const std::vector<ConfigError>& known_;
  std::vector<ConfigError> errors_;
};

}  // namespace

std::vector<ConfigError> check_config(const LoadedConfig& loaded, const std::vector<ConfigError>& known) {
  const core::DetectionConfig& detection = loaded.config.core.detection;
  const core::AssociationConfig& association = loaded.config.core.association;
  const core::Capacities& capacities = loaded.config.core.capacities;
  const double cells = grid_cells(detection);
  const double edges = edges_needed(capacities.map_landmarks, association.depth);
  Rules rules(loaded, known);
  rules.require(detection.tilt_min_rad <= detection.tilt_max_rad,
                {"detection.tilt_min_deg", "detection.tilt_max_deg"}, "is above");
  rules.require(detection.range_min_m < detection.range_max_m,
                {"detection.range_min_m", "detection.range_max_m"}, "is not below");
  rules.require(detection.range_step_m <= detection.range_max_m,
                {"detection.range_step_m", "detection.range_max_m"}, "is above");
  rules.require(cells <= kGridCellsMax,
                {"detection.range_step_m", "detection.bearing_step_deg", "detection.range_max_m"},
                "makes a grid of " + real_text(cells) + " cells, more than the allowed " +
                    real_text(kGridCellsMax) + ", with");
  rules.require(association.landmarks_min <= detection.landmarks_max,
                {"association.landmarks_min", "detection.landmarks_max"},
                "leaves no scan to be searched: it is above");
  rules.require(capacities.occupied_cells >= grid_columns(detection),
                {"capacities.occupied_cells", "detection.bearing_step_deg"},
                "is too small for the cells of one scanline all the way round,");
  rules.require(capacities.scan_landmarks >= detection.landmarks_max,
                {"capacities.scan_landmarks", "detection.landmarks_max"}, "is too small for");
  rules.require(capacities.map_landmarks >= detection.landmarks_max,
                {"capacities.map_landmarks", "detection.landmarks_max"},
                "is too small for the landmarks of one scan,");
  rules.require(capacities.map_edges >= edges,
                {"capacities.map_edges", "capacities.map_landmarks", "association.depth"},
                "is too small: " + std::to_string(static_cast<long long>(edges)) + " edges are needed with");
  return rules.take_errors();
}

}  // namespace slamsensor::firmware
