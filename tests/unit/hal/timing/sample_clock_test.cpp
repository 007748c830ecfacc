#include "hal/timing/sample_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

namespace slamsensor::hal {
namespace {

using std::chrono::milliseconds;

struct Line {
  double rate_hz = 1000.0;
  double off_ppm = 0.0;
  double lump_s = 0.0;        // reads happen at multiples of this
  double jitter_s = 0.0;      // mean of an exponential delay of each read
  double record_s = 0.78e-3;  // line time of a record
  double loss = 0.0;          // share of readings that do not come through
  double stall_every_s = 0.0;
  bool loss_is_known = false;
};

struct Simulated {
  std::vector<double> sent_s;
  std::vector<double> latest_s;
  std::vector<std::size_t> lost;  // before each
};

/// Arrivals of one record after another as a driver computes them: lumps read late, each record dated back by
/// the line time of what the same read brought after it.
Simulated simulate(const Line& line, std::size_t readings, std::uint32_t seed) {
  std::mt19937 engine(seed);
  std::exponential_distribution<double> delay(line.jitter_s > 0.0 ? 1.0 / line.jitter_s : 1.0);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  const double period_s = (1.0 + line.off_ppm * 1e-6) / line.rate_hz;
  Simulated out;
  std::vector<double> read_s;
  double last_read_s = 0.0;
  std::size_t lost = 0;
  for (std::size_t i = 0; i < readings; ++i) {
    const double sent_s = 5.0 + static_cast<double>(i) * period_s;
    const double complete_s = sent_s + line.record_s;
    double at_s = line.lump_s > 0.0 ? std::ceil(complete_s / line.lump_s) * line.lump_s : complete_s;
    if (line.stall_every_s > 0.0 && std::fmod(at_s, line.stall_every_s) < 0.1) {
      at_s += 0.1 - std::fmod(at_s, line.stall_every_s);
    }
    if (at_s > last_read_s) {
      last_read_s = at_s + (line.jitter_s > 0.0 ? delay(engine) : 0.0);
    }
    if (chance(engine) < line.loss) {
      ++lost;
    } else {
      out.lost.push_back(std::exchange(lost, std::size_t{0}));
      out.sent_s.push_back(sent_s);
      read_s.push_back(std::max(last_read_s, complete_s));
    }
  }
  for (std::size_t i = 0; i < read_s.size(); ++i) {
    std::size_t after = 0;
    while (i + after + 1 < read_s.size() && read_s[i + after + 1] == read_s[i]) {
      ++after;
    }
    out.latest_s.push_back(read_s[i] - static_cast<double>(after + 1) * line.record_s);
  }
  return out;
}

struct Error {
  double rms_s = 0.0;
  double worst_s = 0.0;
  double arrival_rms_s = 0.0;
};

/// Errors about their mean (a constant is latency, which is found elsewhere), after the first second.
Error measure(SampleClock& clock, const Simulated& in, const Line& line) {
  clock.set_rate(line.rate_hz);
  std::vector<double> errors;
  double arrival_mean = 0.0;
  double arrival_square = 0.0;
  Stamp before = Stamp::min();
  for (std::size_t i = 0; i < in.sent_s.size(); ++i) {
    std::array<Stamp, 1> stamp{};
    if (line.loss_is_known) {
      clock.skip(in.lost[i]);
    }
    clock.stamp(from_seconds(in.latest_s[i]), stamp);
    EXPECT_GT(stamp[0], before);
    before = stamp[0];
    if (in.sent_s[i] < 6.0) {
      continue;
    }
    errors.push_back(to_seconds(stamp[0]) - in.sent_s[i]);
    arrival_mean += in.latest_s[i] - in.sent_s[i];
    arrival_square += (in.latest_s[i] - in.sent_s[i]) * (in.latest_s[i] - in.sent_s[i]);
  }
  const auto count = static_cast<double>(errors.size());
  double mean = 0.0;
  for (const double error : errors) {
    mean += error / count;
  }
  Error out;
  for (const double error : errors) {
    out.rms_s += (error - mean) * (error - mean) / count;
    out.worst_s = std::max(out.worst_s, std::abs(error - mean));
  }
  out.rms_s = std::sqrt(out.rms_s);
  arrival_mean /= count;
  out.arrival_rms_s = std::sqrt(arrival_square / count - arrival_mean * arrival_mean);
  return out;
}

struct Case {
  const char* name;
  Line line;
  double rms_limit_s;
};

class Reconstruction : public testing::TestWithParam<Case> {};

TEST_P(Reconstruction, IsCloserThanArrival) {
  const Case& c = GetParam();
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    SampleClock clock({});
    const auto readings = static_cast<std::size_t>(30.0 * c.line.rate_hz);
    const Error error = measure(clock, simulate(c.line, readings, seed), c.line);
    std::printf("%-28s seed %u: rms %.4f ms, worst %.3f ms (arrival: rms %.3f ms)\n", c.name, seed,
                error.rms_s * 1e3, error.worst_s * 1e3, error.arrival_rms_s * 1e3);
    EXPECT_LT(error.rms_s, c.rms_limit_s) << c.name << " seed " << seed;
    EXPECT_LT(error.rms_s, error.arrival_rms_s) << c.name << " seed " << seed;
  }
}

const std::array kCases = {
    Case{"1 kHz, 16 ms lumps", {.lump_s = 0.016, .jitter_s = 50e-6}, 0.1e-3},
    Case{"1 kHz, 16 ms, +150 ppm", {.off_ppm = 150, .lump_s = 0.016, .jitter_s = 50e-6}, 0.3e-3},
    Case{"1 kHz, 16 ms, -1500 ppm", {.off_ppm = -1500, .lump_s = 0.016, .jitter_s = 50e-6}, 0.2e-3},
    Case{"1 kHz, 1 ms lumps", {.off_ppm = 120, .lump_s = 0.001, .jitter_s = 200e-6}, 0.3e-3},
    Case{"1 kHz, jitter 0.5 ms", {.off_ppm = -40, .jitter_s = 500e-6}, 0.1e-3},
    Case{"1 kHz, 16 ms, 0.1 % lost",
         {.off_ppm = 150, .lump_s = 0.016, .jitter_s = 50e-6, .loss = 0.001},
         0.7e-3},
    Case{"1 kHz, 16 ms, 1 % known lost",
         {.off_ppm = 150, .lump_s = 0.016, .jitter_s = 50e-6, .loss = 0.01, .loss_is_known = true},
         0.3e-3},
    Case{"1 kHz, stalls of 0.1 s",
         {.off_ppm = 150, .lump_s = 0.004, .jitter_s = 50e-6, .stall_every_s = 3.0},
         0.3e-3},
    Case{"100 Hz, 16 ms lumps", {.rate_hz = 100, .off_ppm = 90, .lump_s = 0.016, .jitter_s = 50e-6}, 1.5e-3},
    Case{"5 kHz, 16 ms lumps",
         {.rate_hz = 5000, .off_ppm = 90, .lump_s = 0.016, .jitter_s = 50e-6, .record_s = 1e-4},
         0.2e-3},
};

INSTANTIATE_TEST_SUITE_P(Lines, Reconstruction, testing::ValuesIn(kCases));

Stamp stamp_one(SampleClock& clock, Stamp latest) {
  std::array<Stamp, 1> stamp{};
  clock.stamp(latest, stamp);
  return stamp[0];
}

TEST(SampleClock, ExactArrivalsGiveExactStamps) {
  SampleClock clock({});
  clock.set_rate(1000.0);
  for (int i = 0; i < 5000; ++i) {
    const Stamp sent = milliseconds(i + 7);
    EXPECT_NEAR(to_seconds(stamp_one(clock, sent) - sent), 0.0, 2e-8) << i;
  }
  EXPECT_EQ(clock.missing(), 0u);
  EXPECT_EQ(clock.relocks(), 0u);
}

TEST(SampleClock, GapBecomesWholePeriods) {
  SampleClock clock({});
  clock.set_rate(1000.0);
  Stamp stamp{};
  for (int i = 0; i < 1000; ++i) {
    const int lost = i >= 500 ? 37 : 0;
    stamp = stamp_one(clock, milliseconds(i + lost));
  }
  EXPECT_EQ(clock.missing(), 37u);
  EXPECT_NEAR(to_seconds(stamp), 1.036, 1e-6);
}

TEST(SampleClock, ReadingsKnownToBeLostLeaveNoTrace) {
  SampleClock clock({});
  clock.set_rate(1000.0);
  for (int i = 0; i < 1000; ++i) {
    const int lost = i >= 500 ? 3 : 0;
    if (i == 500) {
      clock.skip(3);
    }
    const Stamp sent = milliseconds(i + lost);
    EXPECT_NEAR(to_seconds(stamp_one(clock, sent) - sent), 0.0, 2e-8) << i;
  }
  EXPECT_EQ(clock.missing(), 0u);
}

TEST(SampleClock, WrongGuessOfLossIsUndoneByTheNextArrival) {
  SampleClock clock({});
  clock.set_rate(1000.0);
  for (int i = 0; i < 600; ++i) {
    if (i == 300) {
      clock.skip(5);
    }
    const Stamp sent = milliseconds(i + 1);
    EXPECT_LE(to_seconds(stamp_one(clock, sent) - sent), 1e-7) << i;
  }
}

TEST(SampleClock, LocksAgainAfterAStop) {
  SampleClock clock({});
  clock.set_rate(1000.0);
  for (int i = 0; i < 500; ++i) {
    (void)stamp_one(clock, milliseconds(i));
  }
  EXPECT_TRUE(clock.settled());
  const Stamp later = milliseconds(2000) + std::chrono::microseconds(345);
  EXPECT_EQ(stamp_one(clock, later), later);
  EXPECT_EQ(clock.relocks(), 1u);
  EXPECT_FALSE(clock.settled());
}

TEST(SampleClock, BlockIsSpreadBackwardsOverItsReadings) {
  SampleClock clock({});
  clock.set_rate(20000.0);
  std::array<Stamp, 200> stamps{};
  Stamp before = Stamp::min();
  for (int packet = 1; packet <= 300; ++packet) {
    clock.stamp(milliseconds(10 * packet), stamps);
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      const Stamp expected =
          milliseconds(10 * packet) - std::chrono::microseconds(50) * (199 - static_cast<int>(i));
      EXPECT_NEAR(to_seconds(stamps[i] - expected), 0.0, 1e-7);
      EXPECT_GT(stamps[i], before);
      before = stamps[i];
    }
  }
}

TEST(SampleClock, PassesArrivalsThroughWhenAsked) {
  SampleClock clock({.timing = SampleTiming::AsArrived});
  clock.set_rate(1000.0);
  EXPECT_TRUE(clock.settled());
  EXPECT_EQ(stamp_one(clock, milliseconds(10)), milliseconds(10));
  EXPECT_EQ(stamp_one(clock, milliseconds(25)), milliseconds(25));
  EXPECT_EQ(stamp_one(clock, milliseconds(25)), milliseconds(25) + Stamp(1));
}

}  // namespace
}  // namespace slamsensor::hal
