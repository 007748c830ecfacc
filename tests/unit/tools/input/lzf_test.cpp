#include "tools/input/lzf.hpp"

#include "tests/unit/tools/input/pcd_writer.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace slamsensor::tools {
namespace {

std::string unpacked(const std::string& packed, std::size_t size) {
  const auto bytes = unpack_lzf(packed, size);
  return bytes ? std::string(bytes->begin(), bytes->end()) : "refused";
}

TEST(Lzf, UnpacksLiteralsAndCopies) {
  EXPECT_EQ(unpacked(std::string("\x02"
                                 "abc",
                                 4),
                     3),
            "abc");
  // Literal "ab", then length 3 + 2 from 2 back: the copy overlaps what it writes.
  EXPECT_EQ(unpacked(std::string("\x01"
                                 "ab\x60\x01",
                                 5),
                     7),
            "abababa");
  // The long form: 7 + 10 + 2 bytes from 1 back.
  EXPECT_EQ(unpacked(std::string("\x00"
                                 "x\xE0\x0A\x00",
                                 5),
                     20),
            std::string(20, 'x'));
  EXPECT_EQ(unpacked("", 0), "");
}

TEST(Lzf, RefusesWhatReadsOrWritesOutOfBounds) {
  EXPECT_FALSE(unpack_lzf(std::string("\x05"
                                      "ab",
                                      3),
                          6))
      << "literal runs past the end";
  EXPECT_FALSE(unpack_lzf(std::string("\x00"
                                      "x\x20",
                                      3),
                          4))
      << "copy without its offset";
  EXPECT_FALSE(unpack_lzf(std::string("\x00"
                                      "x\xE0",
                                      3),
                          20))
      << "copy without its length";
  EXPECT_FALSE(unpack_lzf(std::string("\x00"
                                      "x\x20\x01",
                                      4),
                          4))
      << "copy from before the start";
  EXPECT_FALSE(unpack_lzf(std::string("\x20\x00", 2), 3)) << "copy from nothing";
  EXPECT_FALSE(unpack_lzf(std::string("\x02"
                                      "abc",
                                      4),
                          2))
      << "more than declared";
  EXPECT_FALSE(unpack_lzf(std::string("\x02"
                                      "abc",
                                      4),
                          4))
      << "less than declared";
}

TEST(Lzf, RefusesASizeNoPackingReachesBeforeTakingMemory) {
  EXPECT_FALSE(unpack_lzf(std::string("\x00"
                                      "x\xE0\xFF\x00",
                                      5),
                          std::size_t{1} << 60));
}

TEST(Lzf, ReturnsWhatWasPacked) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::string bytes;
    for (std::size_t size = random() % 3000; bytes.size() < size;) {
      bytes.append(1 + random() % 300 / (1 + random() % 50), static_cast<char>(random() % (1 + seed)));
    }
    EXPECT_EQ(unpacked(pack_lzf(bytes), bytes.size()), bytes);
  }
}

}  // namespace
}  // namespace slamsensor::tools
