// Broken map files: each is refused with the message that its user reads.
#include "firmware/store/map_file.hpp"
#include "firmware/store/map_store.hpp"
#include "firmware/store/store_io.hpp"
#include "firmware/supervision/file_descriptor.hpp"
#include "tests/unit/firmware/store/damage.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <fstream>
#include <functional>
#include <malloc.h>
#include <ostream>
#include <sys/socket.h>
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

// Numbers near their end: such a map could be loaded, but never be extended and saved again.
TEST(BrokenMapFile, AMapWithoutHeadRoomIsRefused) {
  const auto message_with = [](const std::function<void(firmware::MapFile&)>& change) {
    const TempFolder folder;
    firmware::MapFile map = sample_map();
    change(map);
    const Bytes bytes = firmware::encode_map(map.about, map.state());
    (void)folder.write("broken.slammap", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return message_of_load(folder);
  };
  const std::string end =
      "leaves no room for more scans: the map was not written by slamsensor; use an earlier copy of it";
  EXPECT_EQ(message_with([](auto& map) { map.numbers.scans = UINT32_MAX; }),
            "the number of scans 4294967295 " + end);
  EXPECT_EQ(message_with([](auto& map) { map.numbers.scans = 1U << 31U; }), "it was loaded");
  const std::string id = message_with([](auto& map) { map.numbers.next_id = UINT32_MAX; });
  EXPECT_TRUE(id.starts_with("the next landmark's id 4294967295 leaves no room")) << id;
  const std::string seen = message_with([](auto& map) { map.landmarks[3].sightings = UINT32_MAX; });
  EXPECT_TRUE(seen.starts_with("landmark 3 (id 5): its sightings, chances or xi")) << seen;
  const std::string chances = message_with([](auto& map) { map.landmarks[0].chances = UINT32_MAX - 1; });
  EXPECT_TRUE(chances.starts_with("landmark 0 (id 0): its sightings")) << chances;
  const std::string xi = message_with([](auto& map) { map.landmarks[4].xi = UINT32_MAX; });
  EXPECT_TRUE(xi.starts_with("landmark 4 (id 8): its sightings")) << xi;
  const std::string pose = message_with([](auto& map) { map.path[2].xi = UINT32_MAX; });
  EXPECT_TRUE(pose.starts_with("pose 2 of the path")) << pose;
}

TEST(BrokenMapFile, OfAForeignFileNoMoreIsReadThanItsMagic) {
  const TempFolder folder;
  const std::filesystem::path path = folder.write("broken.slammap", "PNG not a map");
  std::filesystem::resize_file(path, firmware::kMapFileBytesMax);
  EXPECT_EQ(firmware::read_regular(path, firmware::kMapFileBytesMax, firmware::kMapMagic)->bytes.size(),
            firmware::kMapMagic.size());
  EXPECT_TRUE(message_of_load(folder).ends_with("is not a map of slamsensor; name a .slammap file"));
}

TEST(BrokenMapFile, MemoryOfAFileGoesBackToTheSystem) {
  const auto mapped_kb = [] {
    std::ifstream status("/proc/self/statm");
    std::size_t pages = 0;
    status >> pages;
    return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) / 1024;
  };
  const TempFolder folder;
  const std::filesystem::path path = folder.write("broken.slammap", "x");
  std::filesystem::resize_file(path, std::size_t{64} << 20);
  mallopt(M_MMAP_MAX, 0);  // as the daemon has it: what the heap has taken stays
  const std::size_t before_kb = mapped_kb();
  EXPECT_EQ(firmware::read_regular(path, firmware::kMapFileBytesMax)->bytes.size(), std::size_t{64} << 20);
  const std::size_t after_kb = mapped_kb();
  mallopt(M_MMAP_MAX, 65'536);
  EXPECT_LT(after_kb, before_kb + 1024);
}

TEST(BrokenMapFile, ASocketIsNoMap) {
  const TempFolder folder;
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  const auto address = firmware::unix_address((folder.path() / "broken.slammap").string());
  ASSERT_TRUE(address && ::bind(socket, address->get(), address->size) == 0);
  ::close(socket);
  EXPECT_EQ(message_of_load(folder),
            "open: No such device or address; it is a socket or a device; move it away");
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
