#include "tests/unit/firmware/control/control_server_fixture.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <sys/stat.h>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;

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
  const auto second = ControlServer::create(config, target.handler());
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
  const auto made = ControlServer::create(config, target.handler());
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("no socket is there; remove it"));
  EXPECT_EQ(std::filesystem::file_size(config.socket), 8U);
}

TEST_F(ControlListenerTest, SaysWhatIsWrongWithThePath) {
  config.socket = folder / "missing" / "socket";
  EXPECT_THAT(ControlServer::create(config, target.handler()).error().message, HasSubstr("make its folder"));
  config.socket = std::string(kUnixPathMax + 1, 'p');
  EXPECT_THAT(ControlServer::create(config, target.handler()).error().message,
              HasSubstr("no path of 1 to 107 bytes"));
  config.socket.clear();
  EXPECT_FALSE(ControlServer::create(config, target.handler()));
}

TEST_F(ControlListenerTest, ADaemonWhoseSocketWasTakenOverLeavesTheNewOneAlone) {
  start();
  std::filesystem::remove(config.socket);
  auto newer = ControlServer::create(config, target.handler());
  ASSERT_TRUE(newer);
  server.reset();
  EXPECT_TRUE(std::filesystem::exists(config.socket));
}

}  // namespace
}  // namespace slamsensor::firmware
