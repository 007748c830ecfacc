#include "firmware/control/control_request.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;

/// The verb and the arguments that `line` stands for.
std::string understood(std::string_view line) {
  const auto request = parse_control_request(line);
  if (!request) {
    return "refused: " + request.error().message;
  }
  EXPECT_NE(request->verb->run, nullptr);
  std::string text(request->verb->words);
  for (const std::string& argument : {request->name, request->value}) {
    text += argument.empty() ? "" : ' ' + argument;
  }
  text += request->form == ReplyForm::Json ? " as json" : "";
  text += request->mode == ScanMode::Single ? " mode single" : "";
  text += request->level == LogLevel::Debug ? " level debug" : "";
  return text;
}

struct Spoken {
  std::string_view line;
  std::string_view means;
};

class Understood : public testing::TestWithParam<Spoken> {};

TEST_P(Understood, IsAVerbWithItsArguments) {
  EXPECT_EQ(understood(GetParam().line), GetParam().means);
}

INSTANTIATE_TEST_SUITE_P(
    Requests, Understood,
    testing::Values(Spoken{"help", "help"}, Spoken{"help map", "help map"}, Spoken{"version", "version"},
                    Spoken{"status", "status"}, Spoken{"status json", "status as json"}, Spoken{"fix", "fix"},
                    Spoken{"fix json", "fix as json"}, Spoken{"counters", "counters"},
                    Spoken{"devices json", "devices as json"}, Spoken{"scan now", "scan now"},
                    Spoken{"scan\t pause ", "scan pause"}, Spoken{"  scan resume", "scan resume"},
                    Spoken{"scan mode continuous", "scan mode"},
                    Spoken{"scan mode single", "scan mode mode single"}, Spoken{"map list", "map list"},
                    Spoken{"map info", "map info"}, Spoken{"map save", "map save"},
                    Spoken{"map save Shed_2-b", "map save Shed_2-b"},
                    Spoken{"map load shed", "map load shed"}, Spoken{"map remove shed", "map remove shed"},
                    Spoken{"map reset", "map reset"}, Spoken{"map freeze", "map freeze"},
                    Spoken{"map unfreeze", "map unfreeze"}, Spoken{"datum show", "datum show"},
                    Spoken{"datum clear", "datum clear"}, Spoken{"datum set -33.5 151.2 12 90", "datum set"},
                    Spoken{"config get association.depth", "config get association.depth"},
                    Spoken{"config set nmea.talker  \"G N\" ", "config set nmea.talker \"G N\""},
                    Spoken{"config unset association.depth", "config unset association.depth"},
                    Spoken{"config list", "config list"}, Spoken{"config reload", "config reload"},
                    Spoken{"record start", "record start"}, Spoken{"record start run1", "record start run1"},
                    Spoken{"record stop", "record stop"}, Spoken{"record status", "record status"},
                    Spoken{"log level debug", "log level level debug"}));

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
  const auto request = parse_control_request("datum set -33.856784 151.215297 12.5 359.5");
  ASSERT_TRUE(request);
  EXPECT_DOUBLE_EQ(request->datum.latitude_deg, -33.856784);
  EXPECT_DOUBLE_EQ(request->datum.longitude_deg, 151.215297);
  EXPECT_DOUBLE_EQ(request->datum.height_m, 12.5);
  EXPECT_DOUBLE_EQ(request->datum.bearing_deg, 359.5);
}

TEST(ControlRequest, HelpNamesEveryRequestOnce) {
  const auto help = control_help("");
  ASSERT_TRUE(help);
  ASSERT_EQ(help->lines.size(), control_verbs().size());
  std::set<std::string_view> words;
  for (std::size_t i = 0; i < help->lines.size(); ++i) {
    EXPECT_TRUE(help->lines[i].starts_with(control_verbs()[i].words));
    EXPECT_TRUE(words.insert(control_verbs()[i].words).second) << control_verbs()[i].words;
    EXPECT_FALSE(control_verbs()[i].description.empty());
  }
  EXPECT_EQ(control_help("map")->lines.size(), 9U);
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
