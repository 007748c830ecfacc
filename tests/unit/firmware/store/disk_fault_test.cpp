// Disks that are full, read-only or not allowed: the map that was there stays.
#include "tests/unit/firmware/store/store_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace slamsensor::firmware {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::StoreBench;

/// While it lives, files of this process cannot grow beyond `bytes`: the write says EFBIG.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = SIG_DFL;
};

/// A file system of its own in `path`; `mounted` only where that is allowed.
class SmallDisk {
 public:
  SmallDisk(std::filesystem::path path, const char* options) : path_(std::move(path)) {
    mounted = ::mount("tmpfs", path_.c_str(), "tmpfs", 0, options) == 0;
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (mounted) {
      ::umount2(path_.c_str(), MNT_DETACH);
    }
  }
  [[nodiscard]] bool remount(unsigned long flags) const {
    return ::mount("tmpfs", path_.c_str(), "tmpfs", MS_REMOUNT | flags, nullptr) == 0;
  }
  bool mounted = false;

 private:
  std::filesystem::path path_;
};

const char* const kNoMount = "SKIPPED: a full or read-only disk takes the right to mount one (root)";

TEST(DiskFault, AWriteThatIsCutShortLeavesTheMap) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  ASSERT_TRUE(bench.save(2));
  for (const rlim_t bytes : {0UL, 1UL, 300UL, 555UL}) {
    const FileSizeLimit limit(bytes);
    const auto saved = bench.save(3);
    ASSERT_FALSE(saved);
    EXPECT_EQ(saved.error().fault, StoreFault::Io);
    EXPECT_EQ(saved.error().message, "map 'm': not saved: " + bench.path("m.slammap").string() +
                                         ": write: File too large; raise the file size limit of the daemon");
  }
  EXPECT_THAT(bench.files(), ElementsAre("m.slammap", "m.slammap.1"));
  EXPECT_EQ(bench.loaded_weight(), 2U);
  EXPECT_TRUE(bench.save(4)) << "when there is room again, it goes on";
  EXPECT_EQ(bench.loaded_weight(), 4U);
}

TEST(DiskFault, AFullDiskLeavesTheMap) {
  StoreBench bench;
  const SmallDisk disk(bench.folder.path(), "size=64k");
  if (!disk.mounted) {
    GTEST_SKIP() << kNoMount;
  }
  ASSERT_TRUE(bench.save(1));
  ASSERT_TRUE(bench.save(2));
  std::string filler(64 * 1024, 'x');
  (void)bench.folder.write("filler", filler);
  const auto saved = bench.save(3);
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().message, "map 'm': not saved: " + bench.path("m.slammap").string() +
                                       ": write: No space left on device; free some space on the disk");
  EXPECT_THAT(bench.files(), ElementsAre("filler", "m.slammap", "m.slammap.1"));
  EXPECT_EQ(bench.loaded_weight(), 2U);
  std::filesystem::remove(bench.path("filler"));
  EXPECT_TRUE(bench.save(4));
}

TEST(DiskFault, ADiskWithoutInodesLeavesTheMap) {
  StoreBench bench;
  const SmallDisk disk(bench.folder.path(),
                       "nr_inodes=5");  // folder, lock, two generations, a new one: no second name
  if (!disk.mounted) {
    GTEST_SKIP() << kNoMount;
  }
  ASSERT_TRUE(bench.save(1));
  ASSERT_TRUE(bench.save(2));
  const auto saved = bench.save(3);
  ASSERT_FALSE(saved);
  EXPECT_THAT(saved.error().message, HasSubstr("No space left on device; free some space on the disk"));
  EXPECT_EQ(bench.loaded_weight(), 2U);
}

TEST(DiskFault, AReadOnlyDiskGivesItsMapsAndTakesNone) {
  StoreBench bench;
  const SmallDisk disk(bench.folder.path(), "size=64k");
  if (!disk.mounted) {
    GTEST_SKIP() << kNoMount;
  }
  ASSERT_TRUE(bench.save(1));
  bench.store = MapStore(bench.folder.path(), core::Capacities{});
  ASSERT_TRUE(disk.remount(MS_RDONLY));
  const auto saved = bench.save(2);
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().message,
            "map folder " + bench.folder.path().string() +
                ": maps cannot be saved: .lock: open: Read-only file system; make the disk writable, or set "
                "map.directory to a folder on another");
  EXPECT_EQ(bench.loaded_weight(), 1U);
  ASSERT_TRUE(disk.remount(0));
  EXPECT_TRUE(bench.save(3)) << "a disk that is writable again is used again";
}

TEST(DiskFault, AFolderThatMayNotBeWrittenSaysSo) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  bench.store = MapStore(bench.folder.path(), core::Capacities{});
  constexpr uid_t kNobody = 65534;
  const bool is_root = ::geteuid() == 0;
  ASSERT_EQ(::chmod(bench.folder.path().c_str(), 0555), 0);
  if (is_root) {
    ASSERT_EQ(::seteuid(kNobody), 0);
  }
  const auto saved = bench.save(2);
  const std::uint64_t loaded = bench.loaded_weight();
  if (is_root) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  ASSERT_EQ(::chmod(bench.folder.path().c_str(), 0755), 0);
  ASSERT_FALSE(saved);
  EXPECT_THAT(saved.error().message,
              HasSubstr("Permission denied; give the daemon's user access to the folder and its files"));
  EXPECT_EQ(loaded, 1U);
}

TEST(DiskFault, AFolderThatCannotBeMadeSaysSo) {
  StoreBench bench;
  (void)bench.folder.write("file", "");
  bench.store = MapStore(bench.path("file") / "maps", core::Capacities{});
  const auto saved = bench.save(1);
  ASSERT_FALSE(saved);
  EXPECT_THAT(saved.error().message, HasSubstr("Not a directory; correct the path, or create the folder"));
}

TEST(DiskFault, AMissingFolderIsMade) {
  StoreBench bench;
  bench.store = MapStore(bench.path("a") / "b", core::Capacities{});
  EXPECT_TRUE(bench.save(1));
  EXPECT_EQ(bench.loaded_weight(), 1U);
}

}  // namespace
}  // namespace slamsensor::firmware
