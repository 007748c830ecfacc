#include "tools/output/text_output.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace slamsensor::tools {
namespace {

using testing::HasSubstr;

class WriteFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "write_file_XXXXXX";
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override {
    ::chmod(folder_.c_str(), 0700);
    std::filesystem::remove_all(folder_);
  }

  static std::string content(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::ptrdiff_t entries() const {
    return std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator());
  }

  std::filesystem::path folder_;
};

TEST_F(WriteFile, WritesAndReplaces) {
  const auto path = folder_ / "a.csv";
  const std::string bytes("1\0\n\xFF", 4);
  ASSERT_TRUE(write_file(path, "old and longer"));
  ASSERT_TRUE(write_file(path, bytes));
  EXPECT_EQ(content(path), bytes);
  EXPECT_EQ(entries(), 1) << "no temporary file is left";
}

using Paths = std::vector<std::filesystem::path>;

std::string refusal(const Paths& outputs, const Paths& inputs) {
  const auto checked = check_outputs(outputs, inputs);
  return checked ? std::string() : checked.error().message;
}

// `replay --out DIR DIR/map.csv` replaced its own input.
TEST_F(WriteFile, AnOutputIsNoneOfTheInputsByAnyName) {
  const auto input = folder_ / "map.csv";
  ASSERT_TRUE(write_file(input, "scan,x_m,y_m\n"));
  std::filesystem::create_directory(folder_ / "sub");
  std::filesystem::create_symlink(input, folder_ / "link.csv");
  std::filesystem::create_symlink("link.csv", folder_ / "link2.csv");
  std::filesystem::create_directory_symlink(folder_, folder_ / "sub/up");
  std::filesystem::create_hard_link(input, folder_ / "hard.csv");
  for (const char* const name :
       {"map.csv", "./map.csv", "sub/../map.csv", "link.csv", "link2.csv", "sub/up/map.csv", "hard.csv"}) {
    EXPECT_THAT(
        refusal({folder_ / "other.csv", folder_ / name}, {"", folder_ / "none", input}),
        testing::AllOf(HasSubstr(name), HasSubstr("it is the input"), HasSubstr("name another output")))
        << name;
  }
  EXPECT_EQ(refusal({folder_ / "sub/map.csv", folder_ / "new.csv", ""}, {input, ""}), "");
}

// `replay --out DIR --landmarks DIR/map.csv` replaced the map that it had just written.
TEST_F(WriteFile, AnOutputIsNoneOfTheOthersByAnyName) {
  std::filesystem::create_directory(folder_ / "sub");
  std::filesystem::create_directory_symlink(folder_, folder_ / "sub/up");
  const auto map = folder_ / "new/map.csv";
  for (const char* const name :
       {"new/map.csv", "./new/map.csv", "sub/../new/map.csv", "sub/up/new/map.csv"}) {
    EXPECT_THAT(refusal({map, folder_ / name}, {}),
                testing::AllOf(HasSubstr("it is the output"), HasSubstr("name another output")))
        << name;
  }
  EXPECT_EQ(refusal({map, folder_ / "map.csv", "", "", "/dev/null", "/dev/null"}, {}), "");
}

TEST_F(WriteFile, NothingButAMapReplacesAMap) {
  const std::string map("\x89SLM\r\n\x1A\nmore", 12);
  for (const char* const name : {"a.slammap", "map.csv"}) {
    const auto path = folder_ / name;
    ASSERT_TRUE(write_file(path, map)) << name;
    const auto written = write_file(path, "id,x_m,y_m\n");
    ASSERT_FALSE(written) << name;
    EXPECT_THAT(written.error().message, testing::AllOf(HasSubstr(name), HasSubstr("map of the sensor")));
    EXPECT_EQ(content(path), map) << name;
    EXPECT_THAT(refusal({path}, {}), HasSubstr("map of the sensor")) << name;
    EXPECT_TRUE(write_file(path, map + "new")) << name;
  }
  EXPECT_FALSE(write_file(folder_ / "new.slammap", "text"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "new.slammap"));
}

TEST_F(WriteFile, TakesTheLongestNameAFileCanHave) {
  const auto path = folder_ / std::string(255, 'n');
  ASSERT_TRUE(write_file(path, "x"));
  EXPECT_EQ(content(path), "x");
}

TEST_F(WriteFile, FollowsASymbolicLink) {
  ASSERT_TRUE(write_file(folder_ / "target", "old"));
  std::filesystem::create_symlink("target", folder_ / "link");
  ASSERT_TRUE(write_file(folder_ / "link", "new"));
  EXPECT_EQ(content(folder_ / "target"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "link"));
}

TEST_F(WriteFile, MissingFolderIsNamedWithAdvice) {
  const auto result = write_file(folder_ / "none" / "a.csv", "x");
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("none/a.csv: No such file or directory; create the folder"));
}

TEST_F(WriteFile, AFolderIsRefused) {
  const auto result = write_file(folder_, "x");
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("name a file, not a folder"));
}

TEST_F(WriteFile, FullDeviceIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const auto result = write_file("/dev/full", "x");
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("/dev/full: No space left on device; free some space"));
}

TEST_F(WriteFile, UnwritableFolderIsAnErrorAndTheOldFileStays) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const auto path = folder_ / "a.csv";
  ASSERT_TRUE(write_file(path, "old"));
  ::chmod(folder_.c_str(), 0500);
  const auto result = write_file(path, "new");
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("make the folder writable"));
  EXPECT_EQ(content(path), "old");
}

}  // namespace
}  // namespace slamsensor::tools
