// A save that is killed at any of its system calls leaves the old map or the new one, never none. What a
// power loss leaves is up to disk and file system and cannot be shown in a process; that everything is asked
// of them in the right order can, and is.
#include "tests/store/traced_child.hpp"
#include "tests/unit/firmware/store/store_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace slamsensor::tests {
namespace {

using testing::ElementsAre;

constexpr std::uint64_t kNew = 9;  // the weight of the map whose save is killed
const char* const kNotes = "somebody's notes";
const char* const kNoTrace = "SKIPPED: this system does not let a process be traced (ptrace)";

/// What stands in the folder before the save.
struct Kind {
  std::string name;
  std::function<void(StoreBench&)> prepare;
  std::uint64_t old_weight = 0;  ///< of the map that is there; 0: none
  bool has_notes = false;        ///< a file that is no map has the map's name
  bool has_links = true;         ///< the file system has hard links
};
void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

void save_up_to(std::uint64_t weight, StoreBench& bench) {
  for (std::uint64_t w = 1; w <= weight; ++w) {
    ASSERT_TRUE(bench.save(w));
  }
}

std::vector<Kind> all_kinds() {
  return {
      {"First", [](StoreBench&) {}},
      {"Second", [](StoreBench& b) { save_up_to(1, b); }, 1},
      {"Third", [](StoreBench& b) { save_up_to(2, b); }, 2},
      {"AfterAnUnfinishedOne",
       [](StoreBench& b) {
         save_up_to(2, b);
         (void)b.folder.write("m.slammap.tmp", "half");
         std::filesystem::create_hard_link(b.path("m.slammap"), b.path("m.slammap.1.tmp"));
       },
       2},
      {"OnlyThePreviousIsThere",
       [](StoreBench& b) {
         save_up_to(2, b);
         std::filesystem::remove(b.path("m.slammap"));
       },
       1},
      {"TheCurrentIsBad",
       [](StoreBench& b) {
         save_up_to(2, b);
         (void)b.folder.write("m.slammap", kNotes);
       },
       1, true},
      {"ThePreviousIsBad",
       [](StoreBench& b) {
         save_up_to(2, b);
         (void)b.folder.write("m.slammap.1", kNotes);
       },
       2, true},
      {"NothingIsGood", [](StoreBench& b) { (void)b.folder.write("m.slammap", kNotes); }, 0, true},
      {"WithoutHardLinks", [](StoreBench& b) { save_up_to(2, b); }, 2, false, false},
      {"ThePreviousIsTheCurrent",
       [](StoreBench& b) {
         save_up_to(1, b);
         std::filesystem::create_hard_link(b.path("m.slammap"), b.path("m.slammap.1"));
       },
       1},
  };
}

/// The save that is traced: that of a new process, which also takes the lock and clears up.
int save_in_child(const StoreBench& bench, const Kind& kind) {
  if (!kind.has_links && !forbid_hard_links()) {
    return 77;
  }
  firmware::MapStore store(bench.folder.path(), core::Capacities{});
  const firmware::MapFile map = sample_map_of_weight(kNew);
  firmware::MapAbout about = map.about;
  about.name = "m";
  return store.save(about, map.state(), kNow_utc_s) ? 0 : 1;
}

void set_up(StoreBench& bench, const Kind& kind) {
  kind.prepare(bench);
  bench.store = firmware::MapStore(bench.folder.path(), core::Capacities{});  // gives the lock back
}

bool holds_notes(const StoreBench& bench) {
  const std::vector<std::string> files = bench.files();
  return std::any_of(files.begin(), files.end(),
                     [&](const std::string& file) { return bench.content(file) == kNotes; });
}

/// What must hold after a kill, whenever it came; and that the next life goes on from there.
void expect_old_or_new(StoreBench& bench, const Kind& kind) {
  const std::uint64_t weight = bench.loaded_weight();
  EXPECT_TRUE(weight == kind.old_weight || weight == kNew) << "loaded " << weight;
  EXPECT_TRUE(!kind.has_notes || holds_notes(bench));
  EXPECT_TRUE(bench.save(kNew + 1));
  EXPECT_EQ(bench.loaded_weight(), kNew + 1);
  EXPECT_TRUE(!kind.has_notes || holds_notes(bench));
  for (const std::string& file : bench.files()) {
    EXPECT_FALSE(file.ends_with(".tmp")) << file;
  }
}

class KilledSave : public testing::TestWithParam<Kind> {};

TEST_P(KilledSave, LeavesTheOldMapOrTheNewOneAtEverySystemCall) {
  const Kind& kind = GetParam();
  std::size_t kills = 0;
  std::size_t new_after = 0;
  for (;; ++kills) {
    StoreBench bench;
    set_up(bench, kind);
    const auto traced = run_traced([&] { return save_in_child(bench, kind); }, kills);
    if (!traced) {
      GTEST_SKIP() << kNoTrace;
    }
    if (!traced->was_killed) {
      ASSERT_EQ(traced->exit_status, 0) << "the save itself failed";
      EXPECT_EQ(bench.loaded_weight(), kNew);
      break;
    }
    SCOPED_TRACE("killed " + std::string(kills % 2 == 0 ? "entering" : "leaving") + " system call " +
                 std::to_string(kills / 2));
    new_after += bench.loaded_weight() == kNew ? 1 : 0;
    expect_old_or_new(bench, kind);
  }
  std::printf("%s: killed at %zu places: the old map %zu times, the new one %zu times\n", kind.name.c_str(),
              kills, kills - new_after, new_after);
  EXPECT_GT(kills, 20U);
  EXPECT_GT(new_after, 0U);
  EXPECT_GT(kills - new_after, 0U);
}

INSTANTIATE_TEST_SUITE_P(Kinds, KilledSave, testing::ValuesIn(all_kinds()),
                         [](const auto& kind) { return kind.param.name; });

/// The changes of the last save of `kind`; none when they cannot be seen.
std::vector<std::string> changes_of(const Kind& kind, StoreBench& bench) {
  set_up(bench, kind);
  const auto traced = run_traced([&] { return save_in_child(bench, kind); });
  if (!traced) {
    return {};
  }
  EXPECT_EQ(traced->exit_status, 0);
  return traced->changes;
}

TEST(SaveOrder, BytesAreOnTheDiskBeforeTheNameIsTakenAndTheNameBeforeTheSaveEnds) {
  StoreBench bench;
  const std::vector<std::string> changes = changes_of(all_kinds()[2], bench);
  if (changes.empty()) {
    GTEST_SKIP() << kNoTrace;
  }
  EXPECT_THAT(changes, ElementsAre("unlink m.slammap.tmp", "write m.slammap.tmp", "fsync m.slammap.tmp",
                                   "unlink m.slammap.1.tmp", "link m.slammap m.slammap.1.tmp",
                                   "rename m.slammap.1.tmp m.slammap.1", "unlink m.slammap.1.tmp",
                                   "rename m.slammap.tmp m.slammap",
                                   "fsync " + bench.folder.path().filename().string()));
}

TEST(SaveOrder, WithoutHardLinksTheOldMapIsThePreviousOneForAMoment) {
  StoreBench bench;
  const std::vector<std::string> changes = changes_of(all_kinds()[8], bench);
  if (changes.empty()) {
    GTEST_SKIP() << kNoTrace;
  }
  EXPECT_THAT(changes, ElementsAre("unlink m.slammap.tmp", "write m.slammap.tmp", "fsync m.slammap.tmp",
                                   "unlink m.slammap.1.tmp", "link m.slammap m.slammap.1.tmp",
                                   "rename m.slammap m.slammap.1", "rename m.slammap.tmp m.slammap",
                                   "fsync " + bench.folder.path().filename().string()));
}

}  // namespace
}  // namespace slamsensor::tests
