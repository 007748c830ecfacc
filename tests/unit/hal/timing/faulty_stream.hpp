#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tests {

inline constexpr double kFault_s = 10.0;  // when the first fault of a case begins
inline constexpr double kEnd_s = 60.0;

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
inline std::size_t chunk_records(double rate_hz) {
  return rate_hz > 2000.0 ? 128 : 56;
}

inline double read_time(double complete_s, const Stream& stream, const Fault& fault) {
  double at_s = std::ceil(complete_s / stream.lump_s) * stream.lump_s;
  for (const auto& [from_s, length_s] : fault.stalls) {
    if (at_s >= from_s && at_s < from_s + length_s) {
      at_s = from_s + length_s;
    }
  }
  return at_s;
}

inline std::vector<SentReading> simulate(const Stream& stream, const Fault& fault, std::uint32_t seed) {
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

}  // namespace slamsensor::tests
