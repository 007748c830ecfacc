#include "firmware/control/control_request.hpp"

#include "tests/unit/firmware/control/fake_control_target.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;

/// What reaches the target.
std::string asked(std::string_view line) {
  FakeControlTarget target;
  const auto request = parse_control_request(line);
  if (!request) {
    return "refused: " + request.error().message;
  }
  const ControlOutcome outcome = request->command->run(*request, 7, target);
  EXPECT_TRUE(outcome && outcome->has_value()) << line;
  return target.asked.empty() ? "answered" : target.asked.back();
}

struct Spoken {
  std::string_view line;
  std::string_view asked;
};

class Understood : public testing::TestWithParam<Spoken> {};

TEST_P(Understood, ReachesTheTarget) {
  EXPECT_EQ(asked(GetParam().line), GetParam().asked);
}

INSTANTIATE_TEST_SUITE_P(
    Requests, Understood,
    testing::Values(Spoken{"help", "answered"}, Spoken{"help map", "answered"}, Spoken{"version", "answered"},
                    Spoken{"status", "answered"}, Spoken{"status json", "answered"},
                    Spoken{"fix", "answered"}, Spoken{"fix json", "answered"}, Spoken{"counters", "answered"},
                    Spoken{"devices json", "answered"}, Spoken{"scan now", "scan_now"},
                    Spoken{"scan\t pause ", "scan_pause"}, Spoken{"  scan resume", "scan_resume"},
                    Spoken{"scan mode continuous", "scan_mode continuous"},
                    Spoken{"scan mode single", "scan_mode single"}, Spoken{"map list", "map_list"},
                    Spoken{"map info", "map_info"}, Spoken{"map save", "map_save"},
                    Spoken{"map save Shed_2-b", "map_save Shed_2-b"},
                    Spoken{"map load shed", "map_load shed"}, Spoken{"map remove shed", "map_remove shed"},
                    Spoken{"map reset", "map_reset"}, Spoken{"map freeze", "map_mode frozen"},
                    Spoken{"map unfreeze", "map_mode growing"}, Spoken{"datum show", "datum_show"},
                    Spoken{"datum clear", "datum_clear"}, Spoken{"datum set -33.5 151.2 12 90", "datum_set"},
                    Spoken{"config get association.depth", "config_get association.depth"},
                    Spoken{"config set nmea.talker  \"G N\" ", "config_set nmea.talker \"G N\""},
                    Spoken{"config unset association.depth", "config_unset association.depth"},
                    Spoken{"config list", "config_list"}, Spoken{"config reload", "config_reload"},
                    Spoken{"record start", "record_start"}, Spoken{"record start run1", "record_start run1"},
                    Spoken{"record stop", "record_stop"}, Spoken{"record status", "record_status"},
                    Spoken{"log level debug", "set_log_level debug"}));

struct Refused {
  std::string_view line;
  ControlErrorCode code;
  std::string_view says;
};

class NotUnderstood : public testing::TestWithParam<Refused> {};

TEST_P(NotUnderstood, IsRefusedWithAdvice) {
  const auto request = parse_control_request(GetParam().line);
  ASSERT_FALSE(request);
  EXPECT_EQ(request.error().code, GetParam().code);
  EXPECT_THAT(request.error().message, HasSubstr(std::string(GetParam().says)));
}

const std::string kLong(kControlLineMax + 1, 'x');
const std::string kLongName = "map load " + std::string(65, 'n');

INSTANTIATE_TEST_SUITE_P(
    Requests, NotUnderstood,
    testing::Values(
        Refused{"staus", ControlErrorCode::Unknown, "did you mean 'status'?"},
        Refused{"frobnicate", ControlErrorCode::Unknown, "help lists all requests"},
        Refused{"top", ControlErrorCode::Unknown, "there is no request 'top'; help"},
        Refused{"STATUS", ControlErrorCode::Unknown, "there is no request 'STATUS'"},
        Refused{"scan", ControlErrorCode::Unknown, "now, pause, resume or mode, not by nothing"},
        Refused{"map lode shed", ControlErrorCode::Unknown, "not by 'lode'"},
        Refused{"version 2", ControlErrorCode::Value, "nothing is known of '2'; say: version"},
        Refused{"status xml", ControlErrorCode::Value, "status [json]"},
        Refused{"map load", ControlErrorCode::Value, "something is missing; say: map load NAME"},
        Refused{"map load ../etc", ControlErrorCode::Value, "1 to 64 of A-Z a-z 0-9 _ -"},
        Refused{kLongName, ControlErrorCode::Value, "is no name"},
        Refused{"map load a b", ControlErrorCode::Value, "nothing is known of 'b'"},
        Refused{"scan mode often", ControlErrorCode::Value, "allowed: continuous, single"},
        Refused{"log level loud", ControlErrorCode::Value, "allowed: error, warning, notice, info, debug"},
        Refused{"datum set 91 0 0 0", ControlErrorCode::Value,
                "latitude_deg: '91' is not allowed; allowed: -90"},
        Refused{"datum set 1 nan 0 0", ControlErrorCode::Value, "longitude_deg: 'nan'"},
        Refused{"datum set 1 2 3", ControlErrorCode::Value, "bearing_deg: ''"},
        Refused{"datum set 1 2 3 4 5", ControlErrorCode::Value, "nothing is known of '5'"},
        Refused{"datum set 1x 2 3 4", ControlErrorCode::Value, "latitude_deg: '1x'"},
        Refused{"config get association.dept", ControlErrorCode::Value, "did you mean association.depth?"},
        Refused{"config set association.depth", ControlErrorCode::Value, "the value is missing"},
        Refused{"map\x01list", ControlErrorCode::Syntax, "control character"},
        Refused{kLong, ControlErrorCode::Syntax, "longer than 1024 bytes"}));

TEST(ControlRequest, DatumIsReadInDegreesAndMetres) {
  FakeControlTarget target;
  const auto request = parse_control_request("datum set -33.856784 151.215297 12.5 359.5");
  ASSERT_TRUE(request);
  ASSERT_TRUE(request->command->run(*request, 1, target));
  EXPECT_DOUBLE_EQ(target.last_datum.latitude_deg, -33.856784);
  EXPECT_DOUBLE_EQ(target.last_datum.longitude_deg, 151.215297);
  EXPECT_DOUBLE_EQ(target.last_datum.height_m, 12.5);
  EXPECT_DOUBLE_EQ(target.last_datum.bearing_deg, 359.5);
}

TEST(ControlRequest, HelpNamesEveryRequestOnce) {
  const auto help = control_help("");
  ASSERT_TRUE(help);
  ASSERT_EQ(help->lines.size(), control_commands().size());
  std::set<std::string_view> words;
  for (std::size_t i = 0; i < help->lines.size(); ++i) {
    EXPECT_TRUE(help->lines[i].starts_with(control_commands()[i].words));
    EXPECT_TRUE(words.insert(control_commands()[i].words).second) << control_commands()[i].words;
    EXPECT_FALSE(control_commands()[i].description.empty());
  }
  EXPECT_EQ(control_help("map")->lines.size(), 8U);
  EXPECT_EQ(control_help("nothing").error().code, ControlErrorCode::NotFound);
}

TEST(ControlAnswer, LinesAreIndentedAndPlain) {
  EXPECT_EQ(answer_text(ControlReply{"3 maps", {"OK", "a\tb", "c\nERROR d"}}),
            " OK\n a?b\n c\n ERROR d\nOK 3 maps\n");
  EXPECT_EQ(answer_text(ControlReply{}), "OK\n");
  EXPECT_EQ(answer_text(tl::unexpected(ControlError{ControlErrorCode::NotFound, "no\nmap"})),
            "ERROR not_found: no?map\n");
}

TEST(ControlAnswer, TooMuchBecomesAnError) {
  const std::string text = answer_text(ControlReply{"", {std::string(kControlAnswerMax, 'x')}});
  EXPECT_TRUE(text.starts_with("ERROR failed: the answer has "));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
}

}  // namespace
}  // namespace slamsensor::firmware
