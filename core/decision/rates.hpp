#pragma once

#include "core/config.hpp"
#include "core/geometry/pose2.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace slamsensor::core {

/// What has been learned of how scans show a map: the spread of matched landmarks, the share of landmarks
/// that have no counterpart, the share of the map's landmarks that a scan shows, by range and bearing,
/// how well it measures their sizes, and how far a trunk's near face is from its centre. Each starts from a
/// prior worth a number of observations, is bounded, and forgets slowly, so that it follows a change of the
/// world. Kept with the map. Plain values.
struct Rates {
  static constexpr std::size_t kRangeBins = 16;
  static constexpr double kRangeBin_m = 6.0;  // the last bin has all that is farther
  static constexpr std::size_t kBearingBins = 36;

  double spread_m2 = 0.0;                   ///< sum of squared residuals over both axes, per axis count below
  double spread_count = 0.0;                ///< observations behind it, axes
  double clutter = 0.0;                     ///< landmarks of scans without a counterpart on explored ground
  double clutter_count = 0.0;               ///< landmarks of scans on explored ground
  std::array<float, kRangeBins> shown{};    ///< landmarks of the map that were seen, by range
  std::array<float, kRangeBins> in_view{};  ///< landmarks of the map that could have been seen, by range
  double second = 0.0;                      ///< landmarks seen once that the next scan in view showed again
  double second_count = 0.0;                ///< chances for it
  std::array<float, kBearingBins> bearings{};  ///< landmarks of scans, by bearing in the sensor's frame
  double offset_m = 0.0;  ///< a landmark's centre lies this much farther than what the sensor measured

  double size_square = 0.0;  ///< sum of squared differences of ln diameters, of one measurement
  double size_count = 0.0;   ///< observations behind it

  /// Hands every number of `rates` to `visit`, always in the same order: eight doubles, kFloats, two doubles.
  template <typename Self, typename Visit>
  static void visit_numbers(Self& rates, const Visit& visit) {
    for (auto* const number :
         {&rates.spread_m2, &rates.spread_count, &rates.clutter, &rates.clutter_count, &rates.second,
          &rates.second_count, &rates.offset_m, &rates.structure_decades}) {
      visit(*number);
    }
    for (auto* const bins : {&rates.shown, &rates.in_view}) {
      std::for_each(bins->begin(), bins->end(), visit);
    }
    std::for_each(rates.bearings.begin(), rates.bearings.end(), visit);
    visit(rates.size_square);
    visit(rates.size_count);
  }
  static constexpr std::size_t kDoubles = 10;
  static constexpr std::size_t kFloats = 2 * kRangeBins + kBearingBins;

  /// Whether scans can have taught these numbers. Only the offset may be negative.
  [[nodiscard]] bool is_possible() const noexcept {
    constexpr double kMost = 1e9;
    constexpr double kOffsetMost_m = 1.0;
    bool is_possible = std::abs(offset_m) <= kOffsetMost_m && structure_decades >= kLeastStructure &&
                       structure_decades <= kMostStructure;
    visit_numbers(*this, [&](const auto& number) {
      const auto value = static_cast<double>(number);
      const bool is_offset = static_cast<const void*>(&number) == &offset_m;
      is_possible = is_possible && (value >= 0.0 || is_offset) && value <= kMost;
    });
    return is_possible;
  }

  [[nodiscard]] static std::size_t range_bin(double range_m) noexcept {
    return std::min(kRangeBins - 1, static_cast<std::size_t>(std::max(0.0, range_m) / kRangeBin_m));
  }
  [[nodiscard]] static std::size_t bearing_bin(double bearing_rad) noexcept {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    const double share = (bearing_rad - kTurn * std::floor(bearing_rad / kTurn)) / kTurn;
    return std::min(kBearingBins - 1, static_cast<std::size_t>(share * static_cast<double>(kBearingBins)));
  }

  /// How far this world repeats itself: a high quantile of the decades by which the second best place of the
  /// map explains a scan. Wrong places that were mapped are a sample of wrong places that were not.
  static constexpr double kStartStructure = 8.0;
  static constexpr double kLeastStructure = 2.0;
  static constexpr double kMostStructure = 60.0;
  double structure_decades = kStartStructure;

  /// A scan whose second best place elsewhere explained it by `decades`, and `news` of whose landmarks, as a
  /// share, stand on ground that taught nothing before: a hundred scans of one copse say no more of the world
  /// than one.
  void see_runner_up(double decades, double news) noexcept {
    constexpr double kQuantile = 0.98;
    constexpr double kStep = 3.0;  // decades
    structure_decades = std::clamp(
        structure_decades + kStep * (decades > structure_decades ? kQuantile : news * (kQuantile - 1.0)),
        kLeastStructure, kMostStructure);
  }

  /// 1 sigma of a matched landmark per axis, of the scan's measurement alone. `start_m` counts as kPrior
  /// observations.
  [[nodiscard]] double sigma_m(double start_m) const noexcept {
    constexpr double kPrior = 40.0;
    return std::clamp(std::sqrt((spread_m2 + kPrior * start_m * start_m) / (spread_count + kPrior)),
                      0.2 * start_m, 3.0 * start_m);
  }
  /// Variance of one measurement of a ln diameter. Until something is learned it is so large that sizes say
  /// nothing.
  [[nodiscard]] double size_variance() const noexcept {
    constexpr double kPrior = 10.0;
    constexpr double kStart = 0.25;
    return std::clamp((size_square + kPrior * kStart) / (size_count + kPrior), 1e-4, 1.0);
  }
  /// Share of a scan's landmarks on explored ground that the map does not have.
  [[nodiscard]] double clutter_share() const noexcept {
    return std::clamp((clutter + 40.0 * 0.25) / (clutter_count + 40.0), 0.05, 0.8);
  }
  /// Share of the map's landmarks at `range_m` in view that a scan shows.
  [[nodiscard]] double detection(double range_m) const noexcept {
    const std::size_t bin = range_bin(range_m);
    const double prior = 10.0;
    return std::clamp((static_cast<double>(shown[bin]) + prior * mean_detection()) /
                          (static_cast<double>(in_view[bin]) + prior),
                      0.02, 0.97);
  }
  /// Share of the landmarks seen once that another scan in view shows: less than of the confirmed ones,
  /// because some of them are nothing that stays.
  [[nodiscard]] double second_detection() const noexcept {
    return std::clamp((second + 20.0 * 0.4) / (second_count + 20.0), 0.02, 0.97);
  }
  [[nodiscard]] double mean_detection() const noexcept {
    double seen = 20.0 * 0.6;
    double could = 20.0;
    for (std::size_t i = 0; i < kRangeBins; ++i) {
      seen += static_cast<double>(shown[i]);
      could += static_cast<double>(in_view[i]);
    }
    return std::clamp(seen / could, 0.05, 0.97);
  }
};

}  // namespace slamsensor::core
