#include "firmware/control/control_server.hpp"
#include "tests/unit/firmware/control/fake_control_target.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace slamsensor::firmware {
namespace {

struct ControlSessionTest : testing::Test {
  /// Runs the session and takes all it has to send, as a quick client does.
  std::string run() {
    std::string output;
    do {
      session.run(target.handler(), last_token, counts);
      output += session.output();
      session.sent(session.output().size());
    } while (session.can_run());
    return output;
  }

  std::string say(std::string_view bytes) {
    session.receive(bytes);
    return run();
  }

  FakeControlTarget target;
  ControlSession session;
  ControlToken last_token = 0;
  SessionCounts counts;
};

TEST_F(ControlSessionTest, AnswersALineHoweverItIsCut) {
  EXPECT_EQ(say("ver"), "");
  EXPECT_EQ(say("sion\r"), "");
  EXPECT_EQ(say("\nmap re"), "OK slamsensord 1.2.3\n");
  EXPECT_EQ(say("set\n"), "OK done\n");
  EXPECT_EQ(counts.requests, 2U);
  EXPECT_EQ(counts.refused, 0U);
}

TEST_F(ControlSessionTest, EmptyLinesAndCommentsSayNothing) {
  EXPECT_EQ(say("\n\r\n   \n# map reset\n"), "");
  EXPECT_TRUE(target.asked.empty());
}

TEST_F(ControlSessionTest, ALastLineWithoutAnEndCounts) {
  EXPECT_EQ(say("version"), "");
  session.end_input();
  EXPECT_EQ(run(), "OK slamsensord 1.2.3\n");
  EXPECT_TRUE(session.is_finished());
}

TEST_F(ControlSessionTest, ALineThatIsTooLongIsRefusedOnceAndSkipped) {
  std::string output;
  const std::string piece(1000, 'x');
  for (int i = 0; i < 20; ++i) {
    output += say(piece);
  }
  output += say("yy\nversion\n");
  EXPECT_EQ(output,
            "ERROR syntax: the line is longer than 1024 bytes; send shorter ones\nOK slamsensord 1.2.3\n");
  EXPECT_EQ(counts.too_long, 1U);
}

TEST_F(ControlSessionTest, TheLongestLineIsTaken) {
  const std::string line = "config set nmea.talker " + std::string(kControlLineMax - 23, 'v');
  ASSERT_EQ(line.size(), kControlLineMax);
  EXPECT_EQ(say(line + "\r\n"), "OK done\n");
  EXPECT_EQ(say(line + "v\n").substr(0, 13), "ERROR syntax:");
}

TEST_F(ControlSessionTest, LaterAnswersKeepTheOrder) {
  target.manner = FakeControlTarget::Manner::Later;
  EXPECT_EQ(say("map save\nversion\n"), "");
  ASSERT_EQ(target.tokens.size(), 1U);
  EXPECT_TRUE(session.is_pending());
  EXPECT_FALSE(session.complete(target.tokens[0] + 1, ControlReply{"other", {}}));
  EXPECT_TRUE(session.complete(target.tokens[0], ControlReply{"saved", {"512 landmarks"}}));
  EXPECT_FALSE(session.complete(target.tokens[0], ControlReply{"twice", {}}));
  EXPECT_EQ(run(), " 512 landmarks\nOK saved\nOK slamsensord 1.2.3\n");
}

TEST_F(ControlSessionTest, GivenUpRequestsTimeOutAndFreeTheLine) {
  target.manner = FakeControlTarget::Manner::Later;
  say("map save\nversion\n");
  session.give_up("no answer");
  EXPECT_EQ(run(), "ERROR timeout: no answer\nOK slamsensord 1.2.3\n");
  EXPECT_FALSE(session.complete(target.tokens[0], ControlReply{"saved", {}}));
}

TEST_F(ControlSessionTest, NothingIsAskedWhileAnAnswerIsUnsent) {
  session.receive("map reset\nmap list\n");
  session.run(target.handler(), last_token, counts);
  session.run(target.handler(), last_token, counts);
  EXPECT_EQ(target.asked, std::vector<std::string>{"map reset"});
  session.sent(3);
  EXPECT_EQ(session.output(), "done\n");
  EXPECT_FALSE(session.can_run());
  session.sent(5);
  EXPECT_TRUE(session.can_run());
}

TEST_F(ControlSessionTest, RefusalsAndFaultsOfTheTargetAreAnswers) {
  target.manner = FakeControlTarget::Manner::Refusing;
  EXPECT_EQ(say("scan now\n"), "ERROR refused: not now; wait\n");
  target.manner = FakeControlTarget::Manner::Throwing;
  EXPECT_EQ(say("scan now\n"),
            "ERROR failed: out of ideas; this is a fault of the program, please report it\n");
  EXPECT_FALSE(session.is_pending());
  EXPECT_EQ(counts.refused, 2U);
}

TEST_F(ControlSessionTest, HoldsNoMoreThanItSays) {
  target.manner = FakeControlTarget::Manner::Later;
  say("map save\n");
  const std::string flood(10 * ControlSession::kInputMax, 'z');
  session.receive(flood);
  EXPECT_EQ(session.room(), 0U);
}

/// Requests in random pieces are answered as they are in one piece.
TEST_F(ControlSessionTest, PiecesMakeNoDifference) {
  const std::string script = "version\nmap save a\n\nbogus\nmap load\n#x\nscan now\n" +
                             std::string(3000, 'q') + "\nmap list\nversion";
  ControlSession whole;
  std::string expected;
  for (std::size_t at = 0; at < script.size() || whole.can_run();) {
    const std::size_t size = std::min(whole.room(), script.size() - at);
    whole.receive(std::string_view(script).substr(at, size));
    at += size;
    if (at == script.size()) {
      whole.end_input();
    }
    whole.run(target.handler(), last_token, counts);
    expected += whole.output();
    whole.sent(whole.output().size());
  }
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    session = ControlSession();
    std::string output;
    for (std::size_t at = 0; at < script.size();) {
      const std::size_t size = std::min<std::size_t>(1 + random() % 700, script.size() - at);
      output += say(std::string_view(script).substr(at, size));
      at += size;
    }
    session.end_input();
    output += run();
    ASSERT_EQ(output, expected) << "seed " << seed;
    ASSERT_TRUE(session.is_finished()) << "seed " << seed;
  }
}

TEST_F(ControlSessionTest, AnswersAreUtf8WhateverTheRequestWas) {
  EXPECT_EQ(say("fl\xFFy \xC3\n").find_first_of("\xFF\xC3"), std::string::npos);
  EXPECT_EQ(counts.refused, 1U);
}

}  // namespace
}  // namespace slamsensor::firmware
