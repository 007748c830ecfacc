#pragma once

#include "core/association/acceptance.hpp"
#include "core/association/candidate.hpp"
#include "core/association/map_view.hpp"
#include "core/association/paper_search.hpp"
#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/fix.hpp"

#include <span>

namespace slamsensor::core {

/// Searches `map` for the scan and judges what is found. When the configured share of the vertex order gives
/// no clear answer, the search goes on to the end of the order if so configured. At most `variants_max`
/// candidates at one place.
[[nodiscard]] Verdict associate(std::span<const Point2> scan_L, const MapView& map, const Config& config,
                                const Deadline& deadline, PaperSearch& search, Candidates& found) noexcept;

/// Fills in what a fix says of one candidate and its verdict: status, reason, pose, matches, covariance,
/// search end.
void describe(const Verdict& verdict, const Candidates& found, std::size_t candidate,
              std::span<const Point2> scan_L, const MapView& map, const Config& config, Fix& fix) noexcept;

}  // namespace slamsensor::core
