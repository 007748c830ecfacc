#include "firmware/store/map_store.hpp"

#include "tests/unit/firmware/store/golden_maps.hpp"
#include "tests/unit/firmware/store/store_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slamsensor::firmware {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::StoreBench;

TEST(MapStore, WhatWasSavedIsLoaded) {
  StoreBench bench;
  const MapFile map = tests::sample_map();
  MapAbout about = map.about;
  about.created_utc_s = 0;
  about.saves = 0;
  const auto saved = bench.store.save(about, map.state(), 1'800'000'000);
  ASSERT_TRUE(saved) << saved.error().message;
  EXPECT_EQ(saved->about.created_utc_s, 1'800'000'000);
  EXPECT_EQ(saved->about.saves, 1U);
  EXPECT_EQ(saved->bytes, std::filesystem::file_size(bench.path("orchard-7.slammap")));
  const auto again = bench.store.save(saved->about, map.state(), 1'800'000'060);
  ASSERT_TRUE(again) << again.error().message;
  const auto loaded = bench.store.load("orchard-7");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->path, bench.path("orchard-7.slammap"));
  EXPECT_EQ(loaded->warning, "");
  EXPECT_EQ(loaded->file.about.created_utc_s, 1'800'000'000);
  EXPECT_EQ(loaded->file.about.saved_utc_s, 1'800'000'060);
  EXPECT_EQ(loaded->file.about.saves, 2U);
  EXPECT_EQ(loaded->file.landmarks.size(), 5U);
  EXPECT_EQ(loaded->file.path.size(), 3U);
}

TEST(MapStore, TheGenerationBeforeIsKept) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  EXPECT_THAT(bench.files(), ElementsAre("m.slammap"));
  const std::string first = bench.content("m.slammap");
  ASSERT_TRUE(bench.save(2));
  EXPECT_THAT(bench.files(), ElementsAre("m.slammap", "m.slammap.1"));
  EXPECT_EQ(bench.content("m.slammap.1"), first);
  const std::string second = bench.content("m.slammap");
  ASSERT_TRUE(bench.save(3));
  EXPECT_EQ(bench.content("m.slammap.1"), second);
  EXPECT_THAT(bench.files(), ElementsAre("m.slammap", "m.slammap.1"));
  EXPECT_EQ(bench.loaded_weight(), 3U);
}

TEST(MapStore, AFirstStartFindsNothingAndSaysSo) {
  StoreBench bench;
  const auto loaded = bench.store.load("m");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().fault, StoreFault::Missing);
  EXPECT_EQ(loaded.error().message, "map 'm': there is none in " + bench.folder.path().string());
}

TEST(MapStore, ADamagedMapGivesWayToTheGenerationBefore) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  ASSERT_TRUE(bench.save(2));
  (void)bench.folder.write("m.slammap", "");
  const auto loaded = bench.store.load("m");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->file.numbers.weight, 1U);
  EXPECT_EQ(loaded->warning, "map 'm': the previous generation " + bench.path("m.slammap.1").string() +
                                 " is used: " + bench.path("m.slammap").string() +
                                 ": the file is empty; use an earlier copy of it");
}

TEST(MapStore, AMissingMapGivesWayToTheGenerationBefore) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  ASSERT_TRUE(bench.save(2));
  std::filesystem::remove(bench.path("m.slammap"));
  const auto loaded = bench.store.load("m");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->file.numbers.weight, 1U);
  EXPECT_THAT(loaded->warning, HasSubstr("No such file"));
}

TEST(MapStore, WhenNoGenerationIsGoodBothReasonsAreReported) {
  StoreBench bench;
  (void)bench.folder.write("m.slammap", "");
  (void)bench.folder.write("m.slammap.1", "x");
  const auto loaded = bench.store.load("m");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().fault, StoreFault::Refused);
  EXPECT_EQ(loaded.error().message,
            "map 'm': not loaded: " + bench.path("m.slammap").string() +
                ": the file is empty; use an earlier copy of it; and the previous generation " +
                bench.path("m.slammap.1").string() +
                ": it begins with \"x\" and is not a map of slamsensor; name a .slammap file");
}

TEST(MapStore, ABadFileIsSetAsideBeforeItsNameIsTaken) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  ASSERT_TRUE(bench.save(2));
  (void)bench.folder.write("m.slammap", "somebody's notes");
  const auto saved = bench.save(3);
  ASSERT_TRUE(saved) << saved.error().message;
  ASSERT_EQ(saved->warnings.size(), 1U);
  EXPECT_EQ(saved->warnings[0], "set aside as " + bench.path("m.slammap.bad-20261123T130509Z").string() +
                                    ": " + bench.path("m.slammap").string() +
                                    ": it begins with \"somebody\" and is not a map of slamsensor; name a "
                                    ".slammap file");
  EXPECT_EQ(bench.content("m.slammap.bad-20261123T130509Z"), "somebody's notes");
  EXPECT_EQ(bench.loaded_weight(), 3U);
  std::filesystem::remove(bench.path("m.slammap"));
  EXPECT_EQ(bench.loaded_weight(), 1U) << "the good generation before is still there";
}

TEST(MapStore, ABadGenerationBeforeIsSetAsideToo) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  (void)bench.folder.write("m.slammap.1", "old notes");
  ASSERT_TRUE(bench.save(2));
  (void)bench.folder.write("m.slammap", "new notes");
  ASSERT_TRUE(bench.save(3));
  EXPECT_EQ(bench.content("m.slammap.bad-20261123T130509Z"), "old notes");
  EXPECT_EQ(bench.content("m.slammap.bad-20261123T130509Z-2"), "new notes");
}

TEST(MapStore, AFolderAndALinkAreSetAsideAsTheyAre) {
  StoreBench bench;
  std::filesystem::create_directory(bench.path("m.slammap"));
  std::filesystem::create_symlink("n.slammap", bench.path("n.slammap"));
  ASSERT_TRUE(bench.save(1));
  ASSERT_TRUE(bench.save(2, "n"));
  EXPECT_EQ(bench.loaded_weight(), 1U);
  EXPECT_EQ(bench.loaded_weight("n"), 2U);
  EXPECT_TRUE(std::filesystem::is_directory(bench.path("m.slammap.bad-20261123T130509Z")));
  EXPECT_TRUE(std::filesystem::is_symlink(bench.path("n.slammap.bad-20261123T130509Z")));
}

TEST(MapStore, AMapThatIsTooLargeForTheConfigurationIsSetAsideNotLost) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  const std::string large = bench.content("m.slammap");
  core::Capacities small;
  small.map_landmarks = 4;
  bench.store = MapStore(bench.folder.path(), small);
  EXPECT_EQ(bench.loaded_weight(), 0U);
  ASSERT_TRUE(bench.save(2));
  EXPECT_EQ(bench.content("m.slammap.bad-20261123T130509Z"), large);
}

TEST(MapStore, WhatIsNoMapIsNotSaved) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  MapFile map = tests::sample_map_of_weight(2);
  map.about.name = "m";
  map.landmarks[1].id = 0;
  const auto saved = bench.store.save(map.about, map.state(), tests::kNow_utc_s);
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().fault, StoreFault::Refused);
  EXPECT_THAT(saved.error().message,
              HasSubstr("map 'm': not saved: landmark 1 (id 0): its id is not larger"));
  const auto empty = bench.store.save(map.about, core::MapState{}, tests::kNow_utc_s);
  EXPECT_FALSE(empty);
  EXPECT_EQ(bench.loaded_weight(), 1U);
  EXPECT_THAT(bench.files(), ElementsAre("m.slammap"));
}

TEST(MapStore, NamesCannotLeaveTheFolder) {
  StoreBench bench;
  for (const char* name : {"", ".", "..", "../m", "a/b", "a.b", "m\n", "/etc/passwd"}) {
    EXPECT_EQ(bench.store.load(name).error().fault, StoreFault::Name) << name;
    EXPECT_EQ(bench.save(1, name).error().fault, StoreFault::Name) << name;
    EXPECT_EQ(bench.store.remove(name).error().fault, StoreFault::Name) << name;
  }
  EXPECT_EQ(bench.store.load("../m").error().message,
            "map name \"../m\": use 1 to 64 characters out of A-Z, a-z, 0-9, _ and -");
  EXPECT_TRUE(bench.files().empty());
}

TEST(MapStore, UnfinishedSavesOfEarlierProcessesAreCleared) {
  StoreBench bench;
  for (const char* file : {"m.slammap.tmp", "m.slammap.1.tmp", "gone.slammap.tmp"}) {
    (void)bench.folder.write(file, "half");
  }
  (void)bench.folder.write("notes.tmp", "mine");
  ASSERT_TRUE(bench.store.prepare());
  EXPECT_THAT(bench.files(), ElementsAre("notes.tmp"));
}

TEST(MapStore, AFolderBelongsToOneProcess) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  MapStore second(bench.folder.path(), core::Capacities{});
  const auto ready = second.prepare();
  ASSERT_FALSE(ready);
  EXPECT_EQ(ready.error().fault, StoreFault::InUse);
  EXPECT_EQ(ready.error().message, "map folder " + bench.folder.path().string() +
                                       ": another process saves maps there; stop it, or give each daemon a "
                                       "map.directory of its own");
  EXPECT_TRUE(second.load("m")) << "what is there may be read";
  bench.store = MapStore("elsewhere", core::Capacities{});
  EXPECT_TRUE(second.prepare()) << "the first is gone";
}

TEST(MapStore, ListsItsMaps) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1, "b"));
  ASSERT_TRUE(bench.save(2, "b"));
  ASSERT_TRUE(bench.save(3, "a"));
  (void)bench.folder.write("c.slammap", "");
  (void)bench.folder.write("c.slammap.bad-20200101T000000Z", "");
  (void)bench.folder.write("readme.txt", "");
  const auto list = bench.store.list();
  ASSERT_TRUE(list);
  ASSERT_EQ(list->size(), 3U);
  EXPECT_EQ((*list)[0].name, "a");
  EXPECT_EQ((*list)[0].good_generations, 1U);
  EXPECT_EQ((*list)[1].name, "b");
  EXPECT_EQ((*list)[1].good_generations, 2U);
  EXPECT_EQ((*list)[1].landmarks, 5U);
  EXPECT_EQ((*list)[1].saved_utc_s, tests::kNow_utc_s);
  EXPECT_EQ((*list)[1].bytes, std::filesystem::file_size(bench.path("b.slammap")));
  EXPECT_TRUE((*list)[1].problems.empty());
  EXPECT_EQ((*list)[2].name, "c");
  EXPECT_EQ((*list)[2].good_generations, 0U);
  EXPECT_EQ((*list)[2].set_aside, 1U);
  EXPECT_THAT((*list)[2].problems, ElementsAre(HasSubstr("the file is empty")));
}

TEST(MapStore, ListTellsAMapThatIsTooLargeFromABadOne) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1, "large"));
  (void)bench.folder.write("bad.slammap", "notes");
  core::Capacities small;
  small.map_landmarks = 4;
  const auto list = MapStore(bench.folder.path(), small).list();
  ASSERT_TRUE(list);
  ASSERT_EQ(list->size(), 2U);
  EXPECT_FALSE((*list)[0].is_too_large);
  EXPECT_TRUE((*list)[1].is_too_large);
  EXPECT_EQ((*list)[1].good_generations, 0U);
  EXPECT_THAT((*list)[1].problems, ElementsAre(HasSubstr("raise capacities.map_landmarks to 5")));
}

TEST(MapStore, ListOfNoFolderSaysWhatToDo) {
  const MapStore store("no-such-folder", core::Capacities{});
  EXPECT_EQ(store.list().error().message,
            "map folder no-such-folder: cannot be read: No such file or directory; create it, or correct "
            "map.directory");
}

TEST(MapStore, RemovesAllGenerations) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1));
  ASSERT_TRUE(bench.save(2));
  (void)bench.folder.write("m.slammap.bad-20200101T000000Z", "");
  ASSERT_TRUE(bench.store.remove("m"));
  EXPECT_THAT(bench.files(), ElementsAre("m.slammap.bad-20200101T000000Z"));
  EXPECT_EQ(bench.store.remove("m").error().fault, StoreFault::Missing);
}

TEST(MapStore, CopiesUnderAFreeNameOnly) {
  StoreBench bench;
  ASSERT_TRUE(bench.save(1, "a"));
  ASSERT_TRUE(bench.save(2, "b"));
  ASSERT_TRUE(bench.store.copy("a", "c", tests::kNow_utc_s));
  EXPECT_EQ(bench.loaded_weight("c"), 1U);
  EXPECT_EQ(bench.store.load("c")->file.about.name, "c");
  EXPECT_EQ(bench.store.copy("a", "b", tests::kNow_utc_s).error().fault, StoreFault::Name);
  EXPECT_EQ(bench.loaded_weight("b"), 2U);
  EXPECT_EQ(bench.store.copy("x", "y", tests::kNow_utc_s).error().fault, StoreFault::Missing);
  EXPECT_EQ(bench.store.copy("a", "../y", tests::kNow_utc_s).error().fault, StoreFault::Name);
}

}  // namespace
}  // namespace slamsensor::firmware
