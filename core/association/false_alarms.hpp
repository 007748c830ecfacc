#pragma once

#include <cstdint>

namespace slamsensor::core {

/// log10 of the chance that at least `hits` of `trials` independent events of chance `p` happen. 0 for hits = 0;
/// -infinity when hits > trials or p = 0. Exact sum, 64-bit, no underflow.
[[nodiscard]] double log10_binomial_tail(std::uint32_t trials, std::uint32_t hits, double p) noexcept;

/// log10 of the expected number of chance poses that match as well as this one (a-contrario bound; Desolneux, Moisan,
/// Morel 2000): `poses_tried` poses, each of which matches 3 landmarks by construction and each of the other
/// `landmarks` - 3 with mean chance `p`; by Hoeffding (1956) the binomial with the mean chance bounds the tail of the
/// unequal ones from above once matches exceed their mean.
[[nodiscard]] double log10_expected_false_alarms(std::uint64_t poses_tried, std::uint32_t landmarks,
                                                 std::uint32_t matches, double p) noexcept;

/// log10 of the chance that a rival pose is the true one although the better pose explains `only_best` landmarks that
/// the rival does not, and the rival `only_rival` that the better one does not (sign test: both equally likely).
[[nodiscard]] double log10_rival_chance(std::uint32_t only_best, std::uint32_t only_rival) noexcept;

}  // namespace slamsensor::core
