#pragma once

#include "core/config.hpp"
#include "core/reading.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tools {

/// The correspondence graph of two scans (DESIGN 2.3): a vertex is a pair (landmark of one, landmark of the
/// other), numbered first * size of the other + second; two are joined when an edge of one landmark graph and
/// an edge of the other, between their elements, agree in length within the tolerance.
struct CorrespondenceGraph {
  std::size_t others = 0;           ///< landmarks of the other scan
  std::vector<std::size_t> degree;  ///< per vertex
  std::vector<std::pair<std::size_t, std::size_t>> edges;
};

/// Empty when the landmarks of a scan cannot be triangulated.
[[nodiscard]] CorrespondenceGraph correspondence_graph(std::span<const core::Point2> scan,
                                                       std::span<const core::Point2> other,
                                                       const core::AssociationConfig& config);

/// That graph as SVG (the paper's Fig. 6): landmarks of the one scan over those of the other, heaviest first,
/// what belongs together by the product's own fix marked.
[[nodiscard]] std::string draw_correspondences(std::span<const core::ScanLandmark> scan,
                                               std::span<const core::ScanLandmark> other,
                                               const core::Config& config, const std::string& title);

}  // namespace slamsensor::tools
