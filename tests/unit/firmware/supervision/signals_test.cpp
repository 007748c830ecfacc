#include "firmware/supervision/signals.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <poll.h>

namespace slamsensor::firmware {
namespace {

bool is_readable(int fd) {
  pollfd state{fd, POLLIN, 0};
  return ::poll(&state, 1, 0) == 1;
}

TEST(Signals, BecomeOrders) {
  auto signals = Signals::create();
  ASSERT_TRUE(signals);
  EXPECT_FALSE(is_readable(signals->fd()));
  EXPECT_EQ(signals->take(), std::nullopt);
  for (const auto& [signal, order] : {std::pair{SIGTERM, Order::Stop},
                                      {SIGINT, Order::Stop},
                                      {SIGHUP, Order::Reload},
                                      {SIGUSR1, Order::SaveMap}}) {
    ASSERT_EQ(::raise(signal), 0);
    EXPECT_TRUE(is_readable(signals->fd()));
    EXPECT_EQ(signals->take(), order);
    EXPECT_EQ(signals->take(), std::nullopt);
  }
}

TEST(Signals, ABrokenPipeIsAnErrorCodeAndTheOldWaysComeBack) {
  struct sigaction before {};
  struct sigaction now {};
  sigset_t mask;
  ::sigaction(SIGPIPE, nullptr, &before);
  {
    const auto signals = Signals::create();
    ASSERT_TRUE(signals);
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    ::close(ends[0]);
    EXPECT_EQ(::write(ends[1], "x", 1), -1);  // would have ended the program
    ::close(ends[1]);
  }
  ::sigaction(SIGPIPE, nullptr, &now);
  EXPECT_EQ(now.sa_handler, before.sa_handler);
  ::pthread_sigmask(SIG_BLOCK, nullptr, &mask);
  EXPECT_EQ(sigismember(&mask, SIGTERM), 0);
}

TEST(Signals, NoneThatIsNoFaultOfTheProgramEndsIt) {
  auto signals = Signals::create();
  ASSERT_TRUE(signals);
  for (int signal = 1; signal <= SIGRTMAX; ++signal) {
    const bool is_fault = signal == SIGILL || signal == SIGTRAP || signal == SIGABRT || signal == SIGBUS ||
                          signal == SIGFPE || signal == SIGSEGV || signal == SIGSYS;
    const bool stops =
        signal == SIGKILL || signal == SIGSTOP || signal == SIGTSTP || signal == SIGTTIN || signal == SIGTTOU;
    const bool is_libcs = signal >= 32 && signal < SIGRTMIN;
    if (!is_fault && !stops && !is_libcs) {
      // Would end the test. qemu-user has no 63 and 64 (EINVAL): what nobody can raise ends nothing.
      ASSERT_TRUE(::raise(signal) == 0 || errno == EINVAL) << signal;
      while (signals->take()) {
      }
    }
  }
  ASSERT_EQ(::raise(SIGQUIT), 0);
  EXPECT_EQ(signals->take(), Order::Stop);
}

TEST(ExitStatus, DistinguishesWhatARestartCannotMend) {
  EXPECT_EQ(exit_status(ExitReason::Ordered), 0);
  EXPECT_EQ(exit_status(ExitReason::Usage), 64);
  EXPECT_EQ(exit_status(ExitReason::Config), 78);
  EXPECT_EQ(exit_status(ExitReason::NoPermission), 77);
  EXPECT_EQ(exit_status(ExitReason::Unavailable), 69);
  EXPECT_EQ(exit_status(ExitReason::NoResources), 71);
  EXPECT_EQ(exit_status(ExitReason::ThreadStalled), 70);
  EXPECT_EQ(exit_status(ExitReason::Fault), 70);
}

}  // namespace
}  // namespace slamsensor::firmware
