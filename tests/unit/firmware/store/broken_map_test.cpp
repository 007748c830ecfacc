// Broken map files: each is refused with the message that its user reads.
#include "firmware/store/map_store.hpp"
#include "tests/unit/firmware/store/damage.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <ostream>
#include <sys/stat.h>
#include <unistd.h>

namespace slamsensor::tests {

void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.name;
}

namespace {

using firmware::MapStore;
using firmware::StoreFault;
using tools::TempFolder;

/// What the store says of DIR/broken.slammap.
std::string message_of_load(const TempFolder& folder, const core::Capacities& capacities = {}) {
  const MapStore store(folder.path(), capacities);
  const auto loaded = store.load("broken");
  if (loaded) {
    return "it was loaded";
  }
  EXPECT_EQ(loaded.error().fault, StoreFault::Refused);
  const std::string begin = "map 'broken': not loaded: " + (folder.path() / "broken.slammap").string() + ": ";
  EXPECT_TRUE(loaded.error().message.starts_with(begin)) << loaded.error().message;
  return loaded.error().message.substr(std::min(begin.size(), loaded.error().message.size()));
}

class BrokenMap : public testing::TestWithParam<Damage> {};

TEST_P(BrokenMap, IsRefusedWithItsMessage) {
  const TempFolder folder;
  const Bytes bytes = GetParam().make();
  (void)folder.write("broken.slammap", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  EXPECT_EQ(message_of_load(folder), GetParam().message);
}

const auto kName = [](const auto& damage) { return damage.param.name; };
INSTANTIATE_TEST_SUITE_P(Damaged, BrokenMap, testing::ValuesIn(damaged_files()), kName);
INSTANTIATE_TEST_SUITE_P(Lying, BrokenMap, testing::ValuesIn(lying_files()), kName);
INSTANTIATE_TEST_SUITE_P(Flawed, BrokenMap, testing::ValuesIn(flawed_maps()), kName);

TEST(BrokenMapFile, TheUnbrokenSampleLoads) {
  const TempFolder folder;
  const Bytes bytes = sample_bytes();
  (void)folder.write("broken.slammap", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  EXPECT_EQ(message_of_load(folder), "it was loaded");
  core::Capacities capacities;
  capacities.map_landmarks = 4;
  EXPECT_EQ(message_of_load(folder, capacities),
            "it holds 5 landmarks and there is room for 4: raise capacities.map_landmarks to 5");
  capacities = {};
  capacities.path_poses = 2;
  EXPECT_EQ(message_of_load(folder, capacities),
            "its path has 3 poses and there is room for 2: raise capacities.path_poses to 3");
}

TEST(BrokenMapFile, AFolderIsNoMap) {
  const TempFolder folder;
  std::filesystem::create_directory(folder.path() / "broken.slammap");
  EXPECT_EQ(message_of_load(folder), "it is a folder; move it away");
}

TEST(BrokenMapFile, ALinkIsNotFollowed) {
  const TempFolder folder;
  std::filesystem::create_symlink("broken.slammap", folder.path() / "broken.slammap");
  EXPECT_EQ(message_of_load(folder),
            "open: Too many levels of symbolic links; it is a symbolic link; put the file itself there");
}

TEST(BrokenMapFile, NobodyWaitsForAPipe) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo((folder.path() / "broken.slammap").c_str(), 0600), 0);
  EXPECT_EQ(message_of_load(folder), "it is not a regular file; move it away");
}

TEST(BrokenMapFile, AHugeFileIsNotRead) {
  const TempFolder folder;
  const auto path = folder.write("broken.slammap", "");
  ASSERT_EQ(::truncate(path.c_str(), (std::int64_t{256} << 20) + 1), 0);
  EXPECT_EQ(message_of_load(folder), "it has 268435457 bytes; a map has at most 268435456; move it away");
}

TEST(BrokenMapFile, OneThatMayNotBeReadSaysSo) {
  const TempFolder folder;
  const auto path = folder.write("broken.slammap", "x");
  ASSERT_EQ(::chmod(path.c_str(), 0), 0);
  constexpr uid_t kNobody = 65534;
  const bool is_root = ::geteuid() == 0;
  if (is_root) {
    ASSERT_EQ(::seteuid(kNobody), 0);
  }
  const std::string message = message_of_load(folder);
  if (is_root) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  EXPECT_EQ(message, "open: Permission denied; give the daemon's user access to the folder and its files");
}

}  // namespace
}  // namespace slamsensor::tests
