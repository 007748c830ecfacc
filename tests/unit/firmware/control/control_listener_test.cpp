#include "tests/unit/firmware/control/control_server_fixture.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <sys/stat.h>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

using ControlListenerTest = ControlServerTest;

TEST_F(ControlListenerTest, SocketIsForOwnerAndGroupWhateverTheMask) {
  const mode_t mask = ::umask(0);
  start();
  ::umask(mask);
  struct stat status {};
  ASSERT_EQ(::lstat(config.socket.c_str(), &status), 0);
  EXPECT_TRUE(S_ISSOCK(status.st_mode));
  EXPECT_EQ(status.st_mode & 07777, 0660U);
  server.reset();
  EXPECT_FALSE(std::filesystem::exists(config.socket));
}

TEST_F(ControlListenerTest, TakesOverASocketThatADeadDaemonLeft) {
  {
    const FileDescriptor dead(::socket(AF_UNIX, SOCK_STREAM, 0));
    const UnixAddress address = unix_address(config.socket).value();
    ASSERT_EQ(::bind(dead.get(), address.get(), address.size), 0);
    ASSERT_EQ(::listen(dead.get(), 1), 0);
  }
  ASSERT_TRUE(std::filesystem::exists(config.socket));
  start();
  const FileDescriptor client = connect();
  say(client, "version\n");
  serve();
  EXPECT_EQ(hear(client), "OK slamsensord 1.2.3\n");
}

TEST_F(ControlListenerTest, RefusesWhereAnotherAnswers) {
  start();
  const auto second = ControlServer::create(config, target.handler(), log);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("another slamsensord answers there"));
  EXPECT_THAT(second.error().message, HasSubstr(config.socket));
  const FileDescriptor client = connect();  // the first is not disturbed
  say(client, "version\n");
  serve();
  EXPECT_THAT(hear(client), HasSubstr("OK slamsensord"));
}

TEST_F(ControlListenerTest, LeavesOtherFilesAlone) {
  std::ofstream(config.socket) << "precious";
  const auto made = ControlServer::create(config, target.handler(), log);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("no socket is there; remove it"));
  EXPECT_EQ(std::filesystem::file_size(config.socket), 8U);
}

TEST_F(ControlListenerTest, SaysWhatIsWrongWithThePath) {
  config.socket = folder / "missing" / "socket";
  EXPECT_THAT(ControlServer::create(config, target.handler(), log).error().message,
              HasSubstr("make its folder"));
  config.socket = std::string(kUnixPathMax + 1, 'p');
  EXPECT_THAT(ControlServer::create(config, target.handler(), log).error().message,
              HasSubstr("no path of 1 to 107 bytes"));
  config.socket.clear();
  EXPECT_FALSE(ControlServer::create(config, target.handler(), log));
}

TEST_F(ControlListenerTest, ADaemonWhoseSocketWasTakenOverLeavesTheNewOneAlone) {
  start();
  std::filesystem::remove(config.socket);
  auto newer = ControlServer::create(config, target.handler(), log);
  ASSERT_TRUE(newer);
  server.reset();
  EXPECT_TRUE(std::filesystem::exists(config.socket));
}

TEST_F(ControlListenerTest, ASocketWhoseFileIsRemovedIsMadeAgainAndClientsStay) {
  start();
  const FileDescriptor early = connect();
  serve();
  std::filesystem::remove(config.socket);
  now += 1s - 1ns;
  serve();
  EXPECT_FALSE(std::filesystem::exists(config.socket)) << "looked at more than once a second";
  now += 1ns;
  serve();
  ASSERT_TRUE(std::filesystem::exists(config.socket));
  const FileDescriptor late = connect();
  for (const FileDescriptor* client : {&early, &late}) {
    say(*client, "version\n");
    serve();
    EXPECT_EQ(hear(*client), "OK slamsensord 1.2.3\n");
  }
  EXPECT_THAT(logged(), HasSubstr(config.socket + ": its file was gone and is made again\n"));
  server.reset();
  EXPECT_FALSE(std::filesystem::exists(config.socket));
}

TEST_F(ControlListenerTest, ASocketOfAnotherDaemonInItsPlaceIsToldOnceAndLeftUntilItGoes) {
  start();
  serve();
  std::filesystem::remove(config.socket);
  auto other = ControlServer::create(config, target.handler(), log).value();
  for (int i = 0; i < 30; ++i) {
    now += 1s;
    serve();
    other->step(now);
  }
  const std::string told = logged();
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 1) << told;
  EXPECT_THAT(told,
              HasSubstr("another slamsensord answers there; stop it or change control.socket; until then "
                        "this daemon cannot be reached\n"));
  EXPECT_LE(other->counters().front().value, 3U) << "probes";
  other.reset();
  now += 10s;
  serve();
  const FileDescriptor client = connect();
  say(client, "version\n");
  serve();
  EXPECT_EQ(hear(client), "OK slamsensord 1.2.3\n");
}

}  // namespace
}  // namespace slamsensor::firmware
