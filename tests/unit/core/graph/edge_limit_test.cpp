#include "core/graph/edge_limit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace slamsensor::core {
namespace {

std::uint64_t admitted(const EdgeLimit& limit, const std::vector<EdgeRank>& ranks, std::size_t lowest) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    EXPECT_EQ(limit.admits(ranks[i]), i < lowest) << "rank number " << i << " of room " << lowest;
    count += limit.admits(ranks[i]) ? 1 : 0;
  }
  return count;
}

// Ranks of all widths, once spread over the whole width and once alike in all but the last few bits.
TEST(EdgeLimit, AdmitsExactlyTheLowest) {
  std::mt19937_64 random(7);
  for (const std::uint32_t bits : {11U, 12U, 40U, 64U, 65U, 128U}) {
    for (const std::uint32_t varied : {10U, bits}) {
      std::vector<EdgeRank> ranks;
      for (int i = 0; i < 500; ++i) {
        const EdgeRank low = ((EdgeRank{random()} << 64U) | random()) >> (128 - varied);
        const EdgeRank high = varied == bits ? EdgeRank{0} : (EdgeRank{1} << (bits - 1));
        ranks.push_back(low | high);
      }
      std::sort(ranks.begin(), ranks.end());
      ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
      for (const std::size_t room : {std::size_t{0}, std::size_t{1}, ranks.size() / 2, ranks.size() - 1}) {
        EdgeLimit limit(bits, room);
        for (std::uint32_t pass = 0; !limit.settled(); ++pass) {
          ASSERT_LE(pass, bits / 11) << "too many passes";
          std::shuffle(ranks.begin(), ranks.end(), random);
          std::for_each(ranks.begin(), ranks.end(), [&](EdgeRank rank) { limit.show(rank); });
          limit.end_pass();
          EXPECT_EQ(limit.total(), ranks.size());
        }
        std::sort(ranks.begin(), ranks.end());
        EXPECT_EQ(admitted(limit, ranks, room), room) << bits << " bits, " << varied << " varied";
      }
    }
  }
}

}  // namespace
}  // namespace slamsensor::core
