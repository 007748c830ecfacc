#pragma once

#include "firmware/control/control_server.hpp"
#include "firmware/supervision/file_descriptor.hpp"
#include "tests/unit/firmware/control/fake_control_target.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <poll.h>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

namespace slamsensor::firmware {

/// A server on a socket of its own, at a time that the test sets, and what clients of it do.
struct ControlServerTest : testing::Test {
  ControlServerTest() {
    folder = std::filesystem::path(testing::TempDir()) / ("control." + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    config.socket = folder / "socket";
  }
  ~ControlServerTest() override {
    server.reset();
    std::fclose(log_file);
    std::filesystem::remove_all(folder);
  }

  void start() {
    auto made = ControlServer::create(config, target.handler(), log);
    ASSERT_TRUE(made) << made.error().message;
    server = std::move(*made);
  }

  FileDescriptor connect() const {
    FileDescriptor client(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const UnixAddress address = unix_address(config.socket).value();
    EXPECT_EQ(::connect(client.get(), address.get(), address.size), 0);
    return client;
  }

  /// The steps of the server that poll asks for, at `now`.
  void serve() {
    server->step(now);
    for (int i = 0; i < 1000; ++i) {
      std::vector<pollfd> interest;
      server->append_interest(interest);
      if (::poll(interest.data(), interest.size(), 0) <= 0) {
        return;
      }
      server->step(now);
    }
    ADD_FAILURE() << "poll never comes to rest";
  }

  static void say(const FileDescriptor& client, std::string_view text) {
    ASSERT_EQ(::send(client.get(), text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }

  /// All that has come; "<end>" where the server closed.
  static std::string hear(const FileDescriptor& client) {
    std::string text;
    std::array<char, 65536> bytes;
    for (;;) {
      const ssize_t count = ::recv(client.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (count <= 0) {
        return count == 0 ? text + "<end>" : text;
      }
      text.append(bytes.data(), static_cast<std::size_t>(count));
    }
  }

  /// What has been logged, all lines.
  std::string logged() const {
    std::string text(4096, '\0');
    const ssize_t size = ::pread(::fileno(log_file), text.data(), text.size(), 0);
    return text.substr(0, static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  }

  std::uint64_t counter(std::string_view name) const {
    for (const hal::Counter& counter : server->counters()) {
      if (counter.name == name) {
        return counter.value;
      }
    }
    ADD_FAILURE() << name;
    return 0;
  }

  std::filesystem::path folder;
  ControlServerConfig config;
  FakeControlTarget target;
  std::FILE* log_file = std::tmpfile();
  Log log{{.fd = ::fileno(log_file)}};
  std::unique_ptr<ControlServer> server;
  hal::Stamp now = std::chrono::seconds(1000);
};

}  // namespace slamsensor::firmware
