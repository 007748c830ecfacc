#include "firmware/daemon/handover.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>

namespace slamsensor::firmware {
namespace {

TEST(Mailbox, HandsOverTheNewestValueOnce) {
  Mailbox<int> box(5);
  EXPECT_FALSE(box.refresh());
  EXPECT_EQ(box.value(), 5);
  box.draft() = 6;
  box.post();
  box.draft() = 7;
  box.post();
  EXPECT_TRUE(box.refresh());
  EXPECT_EQ(box.value(), 7);
  EXPECT_FALSE(box.refresh());
  EXPECT_EQ(box.value(), 7);
}

TEST(Mailbox, ValuesAreNeverTornBetweenThreads) {
  Mailbox<std::array<std::uint64_t, 32>> box;
  std::atomic<bool> stop{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; !stop; ++i) {
      box.draft().fill(i);
      box.post();
    }
  });
  std::uint64_t last = 0;
  bool whole = true;
  int seen = 0;
  // On a busy machine the two threads may take turns of milliseconds.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (seen < 20'000 && std::chrono::steady_clock::now() < end) {
    if (!box.refresh()) {
      std::this_thread::yield();
      continue;
    }
    ++seen;
    for (const std::uint64_t value : box.value()) {
      whole = whole && value == box.value()[0];
    }
    whole = whole && box.value()[0] > last;
    last = box.value()[0];
  }
  stop = true;
  writer.join();
  EXPECT_TRUE(whole);
  EXPECT_GT(seen, 10);
}

}  // namespace
}  // namespace slamsensor::firmware
