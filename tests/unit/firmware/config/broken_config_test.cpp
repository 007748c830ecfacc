// Broken configurations and what each is told: broken/cases.txt, and those that are made here; the messages
// stand in broken/messages.txt. To write that file anew, and then read the difference:
//
//     SLAMSENSOR_REWRITE_MESSAGES=1 unit_firmware --gtest_filter='BrokenConfig.*'

#include "firmware/config/load_config.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

namespace slamsensor::firmware {
namespace {

const std::filesystem::path kBroken = tests::source_tree() / "tests/unit/firmware/config/broken";
constexpr std::string_view kCaseMark = "==== ";
constexpr std::string_view kDropInMark = "---- ";

struct Case {
  std::string name;
  std::string text;                             ///< of the file
  std::map<std::string, std::string> drop_ins;  ///< name to text
};

std::string whole(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::vector<Case> cases() {
  std::istringstream text(whole(kBroken / "cases.txt"));
  std::vector<Case> all;
  std::string* into = nullptr;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with(kCaseMark)) {
      all.push_back({line.substr(kCaseMark.size()), "", {}});
      into = &all.back().text;
    } else if (line.starts_with(kDropInMark)) {
      into = &all.back().drop_ins[line.substr(kDropInMark.size())];
    } else {
      *into += line + '\n';
    }
  }
  return all;
}

/// Messages by case.
using Messages = std::map<std::string, std::string>;

Messages expected_messages() {
  std::istringstream text(whole(kBroken / "messages.txt"));
  Messages all;
  std::string name;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with(kCaseMark)) {
      name = line.substr(kCaseMark.size());
      all[name];
    } else {
      all[name] += line + '\n';
    }
  }
  return all;
}

class BrokenConfig : public testing::Test {
 protected:
  /// What loading `file` says, without the folder; the test fails when it is loaded.
  [[nodiscard]] std::string messages(const std::filesystem::path& file) const {
    const auto loaded = load_config(file);
    EXPECT_FALSE(loaded) << file;
    std::string text = loaded ? "" : error_lines(loaded.error());
    const std::string prefix = file.parent_path().string() + '/';
    for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix)) {
      text.erase(at, prefix.size());
    }
    return text;
  }

  [[nodiscard]] std::string messages(const Case& broken) const {
    std::filesystem::remove_all(folder.path() / "f.toml.d");
    for (const auto& [name, text] : broken.drop_ins) {
      folder.write("f.toml.d/" + name, text);
    }
    return messages(folder.write("f.toml", broken.text));
  }

  tools::TempFolder folder;
};

TEST_F(BrokenConfig, SaysWhereAndWhyAndWhatToDo) {
  std::vector<Case> all = cases();
  all.push_back({"bytes that are no text", "\xff\xfe[detection]\n", {}});
  all.push_back({"a program",
                 std::string("\x7f"
                             "ELF\x02\x01\x01\0\0\0",
                             10),
                 {}});
  all.push_back({"zero bytes", std::string(100, '\0'), {}});
  all.push_back({"a character cut in half", "[map]\nname = \"\xC3\"\n", {}});
  all.push_back({"a larger file than any", std::string((1U << 20U) + 1, '#'), {}});
  all.push_back({"a deep nest", "[ptu]\nrates_baud = " + std::string(5000, '[') + '\n', {}});
  all.push_back({"a key of a thousand letters", "[nmea]\n" + std::string(1000, 'k') + " = 1\n", {}});
  std::string many = "[detection]\n";
  for (int i = 0; i < 250; ++i) {
    many += "nonsense_" + std::to_string(i) + " = 1\n";
  }
  all.push_back({"more mistakes than are told", many, {}});
  const Messages expected = expected_messages();
  std::string written;
  for (const Case& broken : all) {
    std::string told = messages(broken);
    if (broken.name == "more mistakes than are told") {
      told = told.substr(told.find("f.toml:101:"));  // the last of the hundred, and how many more
    }
    written += std::string(kCaseMark) + broken.name + '\n' + told;
    const auto found = expected.find(broken.name);
    EXPECT_EQ(told, found == expected.end() ? "(nothing is expected yet)" : found->second) << broken.name;
    EXPECT_THAT(told, testing::MatchesRegex("f\\.toml(.|\n)*\n")) << "no place: " << broken.name;
  }
  EXPECT_EQ(expected.size(), all.size()) << "messages of cases that are no more";
  EXPECT_GE(all.size(), 60U);
  if (std::getenv("SLAMSENSOR_REWRITE_MESSAGES") != nullptr) {
    std::ofstream(kBroken / "messages.txt", std::ios::binary) << written;
  }
}

TEST_F(BrokenConfig, FileThatIsNoneIsReported) {
  const std::filesystem::path here = folder.path();
  EXPECT_EQ(messages(here / "absent.toml"),
            "absent.toml: cannot be opened: No such file or directory; check the name and the permissions\n");
  std::filesystem::create_directory(here / "folder.toml");
  EXPECT_EQ(messages(here / "folder.toml"), "folder.toml: is a folder; name the file in it\n");
  std::filesystem::create_symlink("loop.toml", here / "loop.toml");
  EXPECT_EQ(messages(here / "loop.toml"),
            "loop.toml: cannot be opened: Too many levels of symbolic links; check the name and the "
            "permissions\n");
  EXPECT_EQ(messages("/proc/self/mem"), "mem: cannot be read: Input/output error\n");
}

TEST_F(BrokenConfig, FileWithoutPermissionIsReported) {
  if (geteuid() == 0) {
    GTEST_SKIP() << "root may read every file; run as another user";
  }
  const std::filesystem::path file = folder.write("f.toml", "");
  std::filesystem::permissions(file, std::filesystem::perms::none);
  EXPECT_EQ(messages(file),
            "f.toml: cannot be opened: Permission denied; check the name and the permissions\n");
}

TEST_F(BrokenConfig, DropInThatCannotBeReadIsReported) {
  folder.write("f.toml", "");
  std::filesystem::create_directories(folder.path() / "f.toml.d" / "a.toml");
  std::filesystem::create_symlink("nowhere", folder.path() / "f.toml.d" / "b.toml");
  EXPECT_EQ(
      messages(folder.path() / "f.toml"),
      "f.toml.d/a.toml: is a folder; name the file in it\n"
      "f.toml.d/b.toml: cannot be opened: No such file or directory; check the name and the permissions\n");
}

}  // namespace
}  // namespace slamsensor::firmware
