#include "tests/bench/matching_task.hpp"

#include "tests/support/forest.hpp"

namespace slamsensor::bench {
namespace {

constexpr std::uint64_t kSeed = 20'001;

std::vector<Query> scans_of(const tests::Forest& forest, std::size_t count, std::uint64_t seed) {
  tests::Draw draw(seed);
  std::vector<Query> queries(count);
  for (Query& query : queries) {
    query.truth_W = tests::pose_in(forest, draw);
    query.scan_L = tests::scan_forest(forest, query.truth_W, {}, draw);
  }
  return queries;
}

}  // namespace

MatchingTask make_matching_task(std::uint32_t landmarks, std::size_t queries, std::size_t foreign) {
  const std::uint64_t seed = kSeed + landmarks;
  tests::Draw here_draw(seed);
  tests::Draw elsewhere_draw(seed + 1'000'000'000);
  const tests::Forest here = tests::make_forest(landmarks, here_draw);
  const tests::Forest elsewhere = tests::make_forest(landmarks, elsewhere_draw);
  return {here.trees_W, scans_of(here, queries, seed + 1), scans_of(elsewhere, foreign, seed + 2)};
}

}  // namespace slamsensor::bench
