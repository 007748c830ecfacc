#pragma once

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// log10 of the chance that at least `hits` of `trials` independent events of chance `p` happen. 0 for hits =
/// 0; -infinity when hits > trials or p = 0. Exact sum, 64-bit, no underflow.
[[nodiscard]] double log10_binomial_tail(std::uint32_t trials, std::uint32_t hits, double p) noexcept;

/// log10 of a bound on the chance that one wrong pose matches as well as this one (a-contrario reasoning;
/// Desolneux, Moisan, Morel 2000, with the scale chosen by the data as in AC-RANSAC, Moisan and Stival 2004).
/// The pose matches 3 of `landmarks` by construction; each other one falls within the tolerance of a map
/// landmark with mean chance `p`, and within a part of it with a chance that shrinks with the area. `shares`
/// are the squared distances of the matches over the squared tolerance, non-decreasing, each in [0, 1]; the
/// bound is the smallest tail over all of them, times their number. By Hoeffding (1956) the binomial with the
/// mean chance bounds the tail of unequal chances from above once matches exceed their mean. 0 for 3 matches
/// or fewer. Multiplied by the poses tried it is the expected number of false alarms.
[[nodiscard]] double log10_chance_of_matches(std::uint32_t landmarks, std::span<const double> shares,
                                             double p) noexcept;

/// log10 of the chance that of two equally good poses one explains at least `best` landmarks better and the
/// other only `rival` (sign test).
[[nodiscard]] double log10_rival_chance(std::uint32_t best, std::uint32_t rival) noexcept;

}  // namespace slamsensor::core
