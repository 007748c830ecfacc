#pragma once

#include "core/config.hpp"
#include "core/decision/explored_ground.hpp"

#include <cstddef>
#include <cstdint>

// Constants of the atlas, each beside its reason. They were chosen on the drives and worlds that
// core/README.md names.
namespace slamsensor::core {

inline constexpr std::uint32_t kHomeAtOnce =
    10;  // landmarks of a first scan that may found the home map by itself
inline constexpr std::uint32_t kHomeConfirmed = 5;  // landmarks seen twice that make a local map the home map
inline constexpr std::uint32_t kReplacingScans =
    15;  // of a map that takes the place of a home map: it has that long to be tied instead
inline constexpr std::uint32_t kReplacingAlone =
    3;  // scans of a map that takes the place of a home map of one scan
inline constexpr std::uint32_t kYoungScans =
    5;                                        // a map of so few is left and found again, hardly a copy of it
inline constexpr double kFoundingOdds = 1e3;  // beyond those of a fix: all that follows builds on it
inline constexpr std::uint32_t kHomeIdleScans = 30;  // without a fix, after which a home map ...
inline constexpr std::uint32_t kHomeSure =
    30;  // ... of fewer confirmed landmarks than this gives way to a larger map
inline constexpr std::uint32_t kMapLandmarksMin = 4;  // of a scan that starts a local map
inline constexpr std::uint32_t kTieLandmarksMin =
    6;                                           // confirmed landmarks of a local map before it may be tied
inline constexpr std::uint32_t kAgainScans = 3;  // back, in which ...
inline constexpr std::uint32_t kAgainMin = 3;    // landmarks that two scans in a row show ...
inline constexpr double kAgainShare =
    0.4;  // ... and this share of all, so that the second shows the first again
inline constexpr std::uint64_t kTieScans =
    3;  // in a row that agree on where a local map lies before it is tied
inline constexpr std::uint64_t kFollowScans = 2;  // the same where it began as the other was left
inline constexpr double kHomeShare =
    0.5;  // of the decades of a local map, with which the home map is still believed
inline constexpr std::uint32_t kGrownScans = 10;  // of a doubtful map that can speak against the home map
inline constexpr double kScansTieDecades = 15.0;  // in all, of scans that agree on where their local map lies
inline constexpr double kPlaceGroups = 3.0;       // decades of groups, and ...
inline constexpr double kPlaceContradiction = 2.0;  // ... decades against, of a scan that counts for a place
inline constexpr double kFirstTurn_rad =
    0.25 * kDegree;                           // 1 sigma: the first fix in a home map is what users align by
inline constexpr double kTieStructure = 7.0;  // a world that repeats itself less than this is tied at once
inline constexpr std::uint32_t kKnownLandmarks = 60;  // confirmed ones of one map; where so many stand ...
inline constexpr double kNoCopiesStructure = 6.5;     // ... and 125 in all showed no copy, no map is doubted
inline constexpr double kNewsPerSample = 5.0;  // landmarks: about as many as stand within the size of a copy
inline constexpr double kThoroughStructure =
    7.5;  // a world that repeats itself more is searched for all rivals
inline constexpr std::size_t kThoroughLandmarks = 15;  // so is a scan of so few, which takes hardly any time
inline constexpr std::size_t kThoroughMost =
    30;  // the heaviest of a longer scan name all places, and the rest are weighed there
inline constexpr std::size_t kWeighedMin = 6;  // candidates that are weighed, however far behind the leader
inline constexpr double kWeighedNats = 15.0;  // others are weighed when they are not farther behind than this
inline constexpr double kContradicted =
    1e-3;  // a landmark goes when so many misses in a row are as unlikely as this
inline constexpr double kNeverThere = 0.02;  // the same of one that was seen once
inline constexpr double kSeldom = 0.12;      // a landmark shown by fewer of its chances than this goes ...
inline constexpr std::uint32_t kSeldomChances = 15;  // ... after so many
inline constexpr std::uint32_t kTakenOutMin =
    6;  // landmarks that a scan brought and later scans contradict, and ...
inline constexpr double kTakenOutShare =
    0.8;  // ... their share, with which the scan is taken out of the map again
inline constexpr double kTwinSigmas = 4.5;     // nearer to a landmark than this, nothing new is put
inline constexpr double kTieGateSigmas = 3.7;  // the same where only scans say how their maps lie
inline constexpr double kTwinGateSigmas =
    3.0;  // nearer to each other than this, landmarks of tied maps are one
inline constexpr std::uint32_t kSaturated =
    60;  // sightings of each match after which a scan adds nothing to the graph
inline constexpr double kLearnApart = 0.03;  // of the scan's reach
// Sizes are learned from a place that leads by its landmarks' places alone: by so many decades at all, and
// against others of its map.
inline constexpr double kSizeDecades = 4.0;
inline constexpr double kSizeLead = 2.0;
inline constexpr double kRatesMemory = 4'000.0;       // observations after which old ones are forgotten
inline constexpr std::uint32_t kRefitAround = 16;     // poses
inline constexpr std::uint32_t kRefitInTurn = 6'000;  // sightings a scan
inline constexpr double kNearFace_m =
    0.15;  // from the face of a trunk to its centre, until a drive shows better
inline constexpr std::uint32_t kOffsetOpenScans =
    20;  // of a map, at each of which that distance is estimated
inline constexpr double kUnknownOffset_m =
    0.12;  // bias of a pose from near faces whose distance to the centres is not known yet
inline constexpr double kUnknownOffset_rad = 0.4 * kDegree;
inline constexpr double kMeanSigmaShare = 0.7;  // spread of a mean of two sightings or more, of a scan's
inline constexpr std::uint32_t kProbeLandmarks =
    40;                                         // of a place of the map that is held against the map itself
inline constexpr double kSurveySharpest = 0.5;  // of the usual spread: no survey teaches a smaller one
inline constexpr double kSurveyedAbout_m = ExploredGround::kCell_m;
inline constexpr std::uint32_t kLoopScans =
    20;  // a landmark unseen for so long closes a loop when it is seen again
inline constexpr double kLayerDecades =
    4.0;                                     // by which a scan is explained by one of two layers of a map ...
inline constexpr double kNearDecades = 3.0;  // ... and places near it that show as much by chance are rarer
inline constexpr std::uint32_t kLayerShared = 3;
inline constexpr std::size_t kLayerScans =
    5;  // no more than one in so many scans may have shown kLayerShared landmarks of both
inline constexpr double kLayerApart_m = 10.0;  // farther apart, or than half the scan's reach, is no drift
inline constexpr double kLayerTurn_rad = 10.0 * kDegree;
inline constexpr std::uint32_t kTwinsInTurn =
    128;  // landmarks that are held against their neighbours, a scan
inline constexpr std::uint32_t kRoomStretch =
    256;  // landmarks among which the least useful makes room, in turn
inline constexpr std::uint32_t kLinkingScans =
    20;  // for which what links two layers of a map counts, however far apart they are
inline constexpr std::uint32_t kStepsAfterLoop = 4;  // of the refinement, one a scan
inline constexpr std::uint32_t kStepScans = 3;       // a step of the refinement after so many scans ...
inline constexpr std::uint64_t kSightingsPerScan =
    3'000;  // ... or more, so that a scan's share of it is this many sightings
// Calibrated on real drives against their references (tests/truth): about what is left of their errors.
inline constexpr double kScanBias_m = 0.04;
inline constexpr double kScanBias_rad = 0.15 * kDegree;
inline constexpr double kFrameBias_rad = 0.09 * kDegree;
inline constexpr double kDriftInflation =
    3.0;  // of the drift's variance, for what sightings' errors have in common
inline constexpr double kLookReach_m = 80.0;  // ground farther than this is not marked as explored

}  // namespace slamsensor::core
