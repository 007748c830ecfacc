#include "tests/unit/firmware/control/control_server_fixture.hpp"

#include <gmock/gmock.h>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

TEST_F(ControlServerTest, AnswersAClientAndLetsItGo) {
  start();
  const FileDescriptor client = connect();
  say(client, "version\nmap list\n");
  serve();
  EXPECT_EQ(hear(client), "OK slamsensord 1.2.3\nOK done\n");
  say(client, "status");
  ::shutdown(client.get(), SHUT_WR);
  serve();
  const std::string answer = hear(client);
  EXPECT_THAT(answer, HasSubstr(" state:"));
  EXPECT_TRUE(answer.ends_with("OK\n<end>"));
  EXPECT_EQ(server->clients(), 0U);
  EXPECT_EQ(counter("requests"), 3U);
}

TEST_F(ControlServerTest, AnswersLaterWithoutKeepingOthersWaiting) {
  start();
  const FileDescriptor slow = connect();
  const FileDescriptor quick = connect();
  target.manner = FakeControlTarget::Manner::Later;
  say(slow, "map save\n");
  serve();
  say(quick, "version\n");
  serve();
  EXPECT_EQ(hear(slow), "");
  EXPECT_EQ(hear(quick), "OK slamsensord 1.2.3\n");
  server->complete(target.tokens.at(0), ControlReply{"saved", {}});
  serve();
  EXPECT_EQ(hear(slow), "OK saved\n");
}

TEST_F(ControlServerTest, ALateAnswerTimesOutAndIsThenUnclaimed) {
  start();
  const FileDescriptor client = connect();
  target.manner = FakeControlTarget::Manner::Later;
  say(client, "map save\n");
  serve();
  now += config.answer_timeout - 1ns;
  serve();
  say(client, "version\n");  // does not prolong the time
  serve();
  EXPECT_EQ(hear(client), "");
  now += 1ns;
  serve();
  EXPECT_EQ(hear(client),
            "ERROR timeout: no answer within 30 s; it may still be done: look at status, and try again\n"
            "OK slamsensord 1.2.3\n");
  server->complete(target.tokens.at(0), ControlReply{"saved", {}});
  serve();
  EXPECT_EQ(hear(client), "");
  EXPECT_EQ(counter("timeouts"), 1U);
  EXPECT_EQ(counter("answers_unclaimed"), 1U);
}

TEST_F(ControlServerTest, AClientThatLeavesWhileItWaitsIsForgotten) {
  start();
  {
    const FileDescriptor client = connect();
    target.manner = FakeControlTarget::Manner::Later;
    say(client, "map save\n");
    serve();
    EXPECT_EQ(server->clients(), 1U);
  }
  serve();  // fails if poll does not come to rest
  EXPECT_EQ(server->clients(), 0U);
  server->complete(target.tokens.at(0), ControlReply{"saved", {}});
  EXPECT_EQ(counter("answers_unclaimed"), 1U);
}

TEST_F(ControlServerTest, AClientThatWaitsWithItsSendingSideClosedGetsItsAnswer) {
  start();
  const FileDescriptor client = connect();
  target.manner = FakeControlTarget::Manner::Later;
  say(client, "map save");
  ::shutdown(client.get(), SHUT_WR);
  serve();
  server->complete(target.tokens.at(0), ControlReply{"saved", {}});
  serve();
  EXPECT_EQ(hear(client), "OK saved\n<end>");
}

TEST_F(ControlServerTest, OneTooManyIsRefusedUntilSomebodyHasBeenSilentForLong) {
  config.clients_max = 2;
  config.idle_min = 60s;
  start();
  const FileDescriptor first = connect();
  serve();
  now += 30s;
  const FileDescriptor second = connect();
  serve();
  const FileDescriptor third = connect();
  serve();
  EXPECT_EQ(hear(third), "ERROR busy: 2 clients are connected; end one of them and try again\n<end>");
  now += 30s;  // the first has been silent for a minute
  const FileDescriptor fourth = connect();
  say(fourth, "version\n");
  serve();
  EXPECT_EQ(hear(first), "<end>");
  EXPECT_EQ(hear(second), "");
  EXPECT_EQ(hear(fourth), "OK slamsensord 1.2.3\n");
  EXPECT_EQ(counter("clients_refused"), 1U);
  EXPECT_EQ(counter("clients_dropped"), 1U);
}

TEST_F(ControlServerTest, AsManyIdleClientsAsThereMayBeLockNobodyOut) {
  start();
  std::vector<FileDescriptor> idle;
  for (std::size_t i = 0; i < kControlClientsMax; ++i) {
    idle.push_back(connect());
    serve();
  }
  now += 1s;
  const FileDescriptor other = connect();
  say(other, "version\n");
  serve();
  EXPECT_EQ(hear(other), "OK slamsensord 1.2.3\n");
  EXPECT_EQ(server->clients(), kControlClientsMax);
}

TEST_F(ControlServerTest, AClientThatDoesNotReadHoldsUpNobodyAndGoes) {
  start();
  target.reply.lines.assign(1, std::string(kControlAnswerMax - 100, 'x'));
  const FileDescriptor deaf = connect();
  say(deaf, "map list\nmap list\nmap list\n");
  serve();
  EXPECT_EQ(target.asked.size(), 1U);  // no more is asked than can be sent
  const FileDescriptor other = connect();
  say(other, "version\n");
  serve();
  EXPECT_EQ(hear(other), "OK slamsensord 1.2.3\n");
  now += config.unread_timeout;
  serve();
  EXPECT_EQ(server->clients(), 1U);
  EXPECT_EQ(counter("clients_dropped"), 1U);
}

TEST_F(ControlServerTest, ManyRequestsAtOnceTakeTurns) {
  start();
  const FileDescriptor busy = connect();
  const FileDescriptor other = connect();
  std::string requests;
  std::string answers;
  for (int i = 0; i < 100; ++i) {
    requests += "version\n";
    answers += "OK slamsensord 1.2.3\n";
  }
  say(busy, requests);
  say(other, "version\n");
  server->step(now);
  EXPECT_EQ(hear(other), "OK slamsensord 1.2.3\n");
  std::string heard = hear(busy);
  EXPECT_LT(heard.size(), answers.size());
  for (int i = 0; i < 100 && heard.size() < answers.size(); ++i) {
    serve();
    heard += hear(busy);
  }
  EXPECT_EQ(heard, answers);
}

TEST_F(ControlServerTest, LongAnswersArriveWhole) {
  start();
  target.reply.lines.assign(1, std::string(kControlAnswerMax - 100, 'x'));
  const FileDescriptor client = connect();
  say(client, "map list\n");
  std::string heard;
  for (int i = 0; i < 1000 && !heard.ends_with("OK done\n"); ++i) {
    serve();
    heard += hear(client);
  }
  EXPECT_EQ(heard, ' ' + target.reply.lines[0] + "\nOK done\n");
}

}  // namespace
}  // namespace slamsensor::firmware
