// What a host or a line does to a periodic stream, and what the clock makes of it: after each fault it must
// be right again within seconds, and as long as it is not it must say so.
#include "hal/timing/sample_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tests {
namespace {

constexpr double kFault_s = 10.0;  // when the first fault of a case begins
constexpr double kEnd_s = 60.0;

/// A device, its line and its host.
struct Stream {
  double rate_hz = 1000.0;
  double lump_s = 0.001;    // the host reads at multiples of this
  double jitter_s = 50e-6;  // mean of an exponential delay of each read
  double off = 0.0;         // share by which the period is longer than nominal
  double drift = 0.0;       // by which that grows in a second
};

/// Times of readings: true and as a driver bounds them.
struct SentReading {
  double sent_s = 0.0;
  double latest_s = 0.0;
  std::size_t guess = 0;  // of readings lost before it
};

struct Fault {
  std::string name;
  std::vector<std::pair<double, double>> stalls = {};          // from, length: the host reads nothing
  std::function<int(std::size_t, double)> copies = {};         // of reading i, sent at t, that get through
  std::function<double(double)> period_off = {};               // at time t, beside the stream's
  std::function<std::size_t(std::size_t, double)> guess = {};  // of readings lost before reading i
  double end_s = kFault_s;                                     // from here on all is well
};

/// Bytes read at once, in records: those behind a record in the same read had to come over the line after it.
std::size_t chunk_records(double rate_hz) {
  return rate_hz > 2000.0 ? 128 : 56;
}

double read_time(double complete_s, const Stream& stream, const Fault& fault) {
  double at_s = std::ceil(complete_s / stream.lump_s) * stream.lump_s;
  for (const auto& [from_s, length_s] : fault.stalls) {
    if (at_s >= from_s && at_s < from_s + length_s) {
      at_s = from_s + length_s;
    }
  }
  return at_s;
}

std::vector<SentReading> simulate(const Stream& stream, const Fault& fault, std::uint32_t seed) {
  std::mt19937 engine(seed);
  std::exponential_distribution<double> delay(1.0 / stream.jitter_s);
  const double record_s = 0.6 / stream.rate_hz;
  std::vector<SentReading> out;
  std::vector<double> read_s;
  double last_lump_s = -1.0;
  double last_read_s = 0.0;
  double sent_s = 5.0;
  for (std::size_t i = 0; sent_s < kEnd_s; ++i) {
    const int copies = fault.copies ? fault.copies(i, sent_s) : 1;
    for (int copy = 0; copy < copies; ++copy) {
      const double lump_s = read_time(sent_s + record_s, stream, fault);
      if (lump_s > last_lump_s) {
        last_lump_s = lump_s;
        last_read_s = std::max(last_read_s, lump_s + delay(engine));
      }
      out.push_back({sent_s, 0.0, fault.guess ? fault.guess(i, sent_s) : 0});
      read_s.push_back(last_read_s);
    }
    const double off =
        stream.off + stream.drift * (sent_s - 5.0) + (fault.period_off ? fault.period_off(sent_s) : 0.0);
    sent_s += (1.0 + off) / stream.rate_hz;
  }
  for (std::size_t i = 0; i < out.size();) {
    std::size_t end = i + 1;
    while (end < out.size() && read_s[end] == read_s[i] && end - i < chunk_records(stream.rate_hz)) {
      ++end;
    }
    for (const std::size_t first = i; i < end; ++i) {
      out[i].latest_s = read_s[first] - static_cast<double>(end - i) * record_s;
    }
  }
  return out;
}

}  // namespace
}  // namespace slamsensor::tests

namespace slamsensor::hal {
namespace {

using namespace tests;  // NOLINT(google-build-using-namespace)

/// What the clock made of a stretch of time.
struct Stretch {
  std::size_t readings = 0;
  std::size_t settled = 0;
  double worst_s = 0.0;  // error of a stamp that was said to be settled, about the mean before the fault
  double rms_s = 0.0;

  void add(bool is_settled, double error_s) {
    ++readings;
    if (is_settled) {
      ++settled;
      worst_s = std::max(worst_s, std::abs(error_s));
      rms_s += error_s * error_s;
    }
  }
  void finish() { rms_s = std::sqrt(rms_s / static_cast<double>(std::max<std::size_t>(settled, 1))); }
  [[nodiscard]] double share() const {
    return readings > 0 ? static_cast<double>(settled) / static_cast<double>(readings) : 0.0;
  }
};

struct Outcome {
  Stretch before;
  Stretch during;  // and for 3 s after
  Stretch after;
  Stretch doubted;  // the fault without its first 2 s: steady faults are known by then
  std::uint64_t missing = 0;
  std::uint64_t missing_before = 0;
  double apparent_hz = 0.0;  // while in doubt
};

Outcome run(const Stream& stream, const Fault& fault, std::uint32_t seed) {
  SampleClock clock({.tolerance_ppm = 10000.0});
  clock.set_rate(stream.rate_hz);
  Outcome out;
  double mean_s = 0.0;
  std::size_t count = 0;
  for (const SentReading& reading : simulate(stream, fault, seed)) {
    std::array<Stamp, 1> stamp{};
    clock.skip(reading.guess);
    clock.stamp(from_seconds(reading.latest_s), stamp);
    const double error_s = to_seconds(stamp[0]) - reading.sent_s;
    if (reading.sent_s < 8.0) {
      continue;
    }
    if (reading.sent_s < kFault_s - 0.1) {
      mean_s += (error_s - mean_s) / static_cast<double>(++count);
      out.missing_before = clock.missing();
    }
    Stretch& stretch = reading.sent_s < kFault_s            ? out.before
                       : reading.sent_s < fault.end_s + 3.0 ? out.during
                                                            : out.after;
    stretch.add(clock.settled(), error_s - mean_s);
    if (reading.sent_s > kFault_s + 2.0 && reading.sent_s < fault.end_s) {
      out.doubted.add(clock.settled(), error_s - mean_s);
      out.apparent_hz = clock.is_in_doubt() ? clock.apparent_rate_hz() : out.apparent_hz;
    }
  }
  for (Stretch* stretch : {&out.before, &out.during, &out.after, &out.doubted}) {
    stretch->finish();
  }
  out.missing = clock.missing() - out.missing_before;
  std::printf(
      "%6.0f Hz %+.1f %% %-24s during %5.1f %% settled, worst %6.3f ms; after %5.1f %%, rms %.3f, worst "
      "%.3f ms; missing %llu\n",
      stream.rate_hz, stream.off * 100.0, fault.name.c_str(), out.during.share() * 100.0,
      out.during.worst_s * 1e3, out.after.share() * 100.0, out.after.rms_s * 1e3, out.after.worst_s * 1e3,
      static_cast<unsigned long long>(out.missing));
  return out;
}

Fault stalls(std::string name, std::vector<std::pair<double, double>> when) {
  Fault fault{.name = std::move(name), .stalls = std::move(when)};
  fault.end_s = fault.stalls.back().first + fault.stalls.back().second;
  return fault;
}

std::vector<Fault> all_stalls() {
  std::vector<Fault> all;
  for (const double length_s : {0.05, 0.1, 0.2, 0.25, 0.29, 0.31, 0.35, 0.4, 0.5, 0.7, 1.0, 2.0}) {
    all.push_back(stalls("stall " + std::to_string(length_s).substr(0, 4) + " s", {{kFault_s, length_s}}));
  }
  all.push_back(stalls("stalls in a row", {{10.0, 0.5}, {10.9, 0.3}, {12.0, 0.25}, {13.5, 0.45}}));
  Fault many = stalls("stalls for 10 s", {{10.0, 0.3}});
  for (int i = 1; i < 10; ++i) {
    many.stalls.emplace_back(10.0 + i, i % 2 == 0 ? 0.3 : 0.5);
  }
  many.end_s = 19.5;
  all.push_back(many);
  return all;
}

/// A fault for ten seconds that lets `copies` of each reading through.
Fault copying(std::string name, std::function<int(std::size_t)> copies) {
  Fault fault{.name = std::move(name)};
  fault.end_s = kFault_s + 10.0;
  fault.copies = [copies = std::move(copies), end_s = fault.end_s](std::size_t i, double at_s) {
    return at_s > kFault_s && at_s < end_s ? copies(i) : 1;
  };
  return fault;
}

Fault other_rate(std::string name, double period_off) {
  Fault fault{.name = std::move(name)};
  fault.end_s = kFault_s + 10.0;
  fault.period_off = [period_off, end_s = fault.end_s](double at_s) {
    return at_s > kFault_s && at_s < end_s ? period_off : 0.0;
  };
  return fault;
}

class FaultyStream : public testing::TestWithParam<Stream> {
 protected:
  /// Reads that beat with the readings look like a reading lost from time to time.
  double limit_s() const {
    const Stream& stream = GetParam();
    const bool beats = stream.off != 0.0 && std::abs(stream.lump_s * stream.rate_hz - 1.0) < 0.1;
    return std::max(beats ? 2.6e-3 : 1e-3, 1.1 / stream.rate_hz);
  }

  void expect_right_again(const Fault& fault, const Outcome& out) const {
    EXPECT_LT(out.before.worst_s, limit_s()) << fault.name;
    EXPECT_GT(out.after.share(), 0.99) << fault.name;
    EXPECT_LT(out.after.worst_s, limit_s()) << fault.name;
  }
};

TEST_P(FaultyStream, IsRightAgainAfterStalls) {
  for (const Fault& fault : all_stalls()) {
    const Outcome out = run(GetParam(), fault, 1);
    expect_right_again(fault, out);
    EXPECT_LT(out.during.worst_s, std::max(4e-3, 2.0 / GetParam().rate_hz)) << fault.name;
  }
}

TEST_P(FaultyStream, StallAtTheStartLeavesNoTrace) {
  for (const double length_s : {0.25, 0.5, 1.0}) {
    const Fault fault = stalls("stall at the start", {{4.9, length_s}});
    const Outcome out = run(GetParam(), fault, 2);
    EXPECT_GT(out.before.share(), 0.99);
    expect_right_again(fault, out);
  }
}

/// Loses a reading in a thousand from kFault_s on; `lost` counts them.
std::function<int(std::size_t, double)> losing(std::uint64_t& lost) {
  return [engine = std::mt19937(7), &lost](std::size_t, double at_s) mutable {
    const bool is_lost = at_s > kFault_s && engine() % 1000 == 0;
    lost += is_lost ? 1 : 0;
    return is_lost ? 0 : 1;
  };
}

TEST_P(FaultyStream, LossesAreCounted) {
  std::uint64_t lost = 0;
  const Fault fault{.name = "0.1 % lost", .copies = losing(lost)};
  const Outcome out = run(GetParam(), fault, 3);
  EXPECT_GT(out.during.share(), 0.99);
  EXPECT_LT(out.after.rms_s, limit_s());
  if (GetParam().off == 0.0) {
    EXPECT_NEAR(static_cast<double>(out.missing), static_cast<double>(lost),
                2.0 + 0.02 * static_cast<double>(lost));
  }
}

TEST_P(FaultyStream, StallsAmongLossesAreRightAgainAndLossesAreCounted) {
  std::uint64_t lost = 0;
  Fault fault = stalls("stalls and 0.1 % lost", {{10.0, 0.5}, {14.0, 0.25}, {17.0, 0.4}});
  fault.copies = losing(lost);
  const Outcome out = run(GetParam(), fault, 3);
  EXPECT_GT(out.after.share(), 0.99);
  EXPECT_LT(out.after.rms_s, limit_s());
  if (GetParam().off == 0.0) {
    // While the period is found anew, losses within its tolerance are taken for another period.
    EXPECT_GT(static_cast<double>(out.missing), 0.6 * static_cast<double>(lost) - 2.0);
    EXPECT_LT(static_cast<double>(out.missing), 1.05 * static_cast<double>(lost) + 3.0);
  }
}

TEST_P(FaultyStream, SteadyFaultsAreInDoubtUntilTheyEnd) {
  const double off = GetParam().off;
  std::vector<Fault> all = {copying("every 20th missing", [](std::size_t i) { return i % 20 == 0 ? 0 : 1; }),
                            copying("every 10th doubled", [](std::size_t i) { return i % 10 == 0 ? 2 : 1; }),
                            other_rate("period 3 % longer", 0.03 - off),
                            other_rate("period 3 % shorter", -0.03 - off),
                            other_rate("period 20 % longer", 0.2 - off)};
  for (const Fault& fault : all) {
    const Outcome out = run(GetParam(), fault, 4);
    EXPECT_LT(out.doubted.share(), 0.02) << fault.name;
    expect_right_again(fault, out);
  }
}

TEST_P(FaultyStream, DoubtReportsTheRate) {
  const Outcome slow = run(GetParam(), other_rate("period 5 % longer", 0.05 - GetParam().off), 5);
  EXPECT_NEAR(slow.apparent_hz * 1.05 / GetParam().rate_hz, 1.0, 0.01);
  const Outcome fast = run(GetParam(), other_rate("period 5 % shorter", -0.05 - GetParam().off), 5);
  EXPECT_NEAR(fast.apparent_hz * 0.95 / GetParam().rate_hz, 1.0, 0.01);
}

TEST_P(FaultyStream, WrongGuessesOfLossAreForgottenWhenTheyEnd) {
  // Noise between the records: the driver takes the bytes for records that did not come through.
  Fault fault{.name = "noise for 5 s"};
  fault.end_s = kFault_s + 5.0;
  std::mt19937 engine(9);
  fault.guess = [&](std::size_t, double at_s) -> std::size_t {
    return at_s > kFault_s && at_s < fault.end_s ? engine() % 1000 : 0;
  };
  expect_right_again(fault, run(GetParam(), fault, 6));
}

TEST_P(FaultyStream, DriftWithinTheToleranceIsFollowed) {
  Stream stream = GetParam();
  stream.off = 0.0;
  stream.drift = 1e-4;
  const Fault fault{.name = "drift of 100 ppm/s"};
  const Outcome out = run(stream, fault, 7);
  EXPECT_GT(out.after.share(), 0.99);
  EXPECT_LT(out.after.worst_s, 2.0 * limit_s());
}

INSTANTIATE_TEST_SUITE_P(
    Rates, FaultyStream,
    testing::Values(Stream{.rate_hz = 388.0}, Stream{.rate_hz = 1000.0}, Stream{.rate_hz = 5000.0},
                    Stream{.rate_hz = 20000.0}, Stream{.rate_hz = 388.0, .off = 0.008},
                    Stream{.rate_hz = 1000.0, .off = 0.008}, Stream{.rate_hz = 5000.0, .off = -0.008},
                    Stream{.rate_hz = 20000.0, .off = 0.008}, Stream{.rate_hz = 1000.0, .lump_s = 0.016},
                    Stream{.rate_hz = 5000.0, .lump_s = 0.016, .off = 0.004}),
    [](const auto& param) {
      return std::to_string(static_cast<int>(param.param.rate_hz)) + "_hz_" + std::to_string(param.index);
    });

}  // namespace
}  // namespace slamsensor::hal
