#pragma once

#include "tools/emulator/emulated_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace slamsensor::tools {

using namespace std::chrono_literals;

using Bytes = std::vector<std::uint8_t>;

/// "AA 40 00" as bytes.
inline Bytes from_hex(const std::string& text) {
  Bytes bytes;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(word, nullptr, 16)));
  }
  return bytes;
}

inline std::string hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    std::array<char, 4> word{};
    std::snprintf(word.data(), word.size(), "%02X", byte);
    text += text.empty() ? "" : " ";
    text += word.data();
  }
  return text;
}

inline std::string text(const Bytes& bytes) {
  return {bytes.begin(), bytes.end()};
}

inline Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

/// A line to the host: remembers what was sent and takes ten bit times for each byte.
class BenchSink final : public ByteSink {
 public:
  struct Sent {
    Stamp begin;
    Stamp end;
    Bytes bytes;
  };

  void send(std::span<const std::uint8_t> bytes, Stamp at) override {
    const Stamp begin = std::max(at, busy_until_);
    busy_until_ = begin + hal::line_time(bytes.size(), device->baud());
    sent.push_back({begin, busy_until_, Bytes(bytes.begin(), bytes.end())});
  }
  [[nodiscard]] Stamp busy_until() const override { return busy_until_; }
  void clear() override {
    ++clears;
    busy_until_ = Stamp{};
  }

  /// All that was sent since the last call.
  Bytes take() {
    Bytes all;
    for (const Sent& each : sent) {
      all.insert(all.end(), each.bytes.begin(), each.bytes.end());
    }
    sent.clear();
    return all;
  }

  const EmulatedSerialDevice* device = nullptr;
  std::vector<Sent> sent;
  int clears = 0;

 private:
  Stamp busy_until_{};
};

/// A scene that is the same thing all the time, or a function of the time.
class BenchScene final : public RangeScene {
 public:
  Target shoot(Stamp at) override {
    shots.push_back(at);
    return of ? of(at) : target;
  }
  void reported(Stamp measured, Stamp on_wire) override { reports.push_back({measured, on_wire}); }

  struct Report {
    Stamp measured;
    Stamp on_wire;
  };
  Target target{TargetKind::Target, 12.34, 0.3};
  std::function<Target(Stamp)> of;
  std::vector<Stamp> shots;
  std::vector<Report> reports;
};

/// A device on its line, driven as a host would.
template <typename Device, typename Settings>
class Bench {
 public:
  explicit Bench(const Settings& settings) : device(settings, sink, scene) { sink.device = &device; }

  /// The host's bytes arrive one after the other at the device's rate; then `wait` passes. Returns what the
  /// device sent.
  Bytes say(const Bytes& bytes, Stamp wait = 10ms) {
    for (const std::uint8_t byte : bytes) {
      now += hal::line_time(1, device.baud());
      device.advance(now);
      device.receive(byte, now);
    }
    return run(wait);
  }
  Bytes say(const std::string& hex_text, Stamp wait = 10ms) { return say(from_hex(hex_text), wait); }

  Bytes run(Stamp length) {
    now += length;
    device.advance(now);
    return sink.take();
  }

  bool inject(FaultKind kind, Stamp duration = Stamp{}) { return device.inject({kind, now, duration}); }

  BenchSink sink;
  BenchScene scene;
  Device device;
  Stamp now{};
};

/// An exchange of a manual: what the host says and what the device shall answer, as hex bytes.
struct Exchange {
  std::string name;
  std::string host;
  std::string device;
};

/// Plays the exchanges, 10 ms apart, and compares. With SLAMSENSOR_TRANSCRIPT set it prints both sides.
template <typename AnyBench>
void play(AnyBench& bench, const std::vector<Exchange>& exchanges) {
  const bool is_told = std::getenv("SLAMSENSOR_TRANSCRIPT") != nullptr;
  for (const Exchange& each : exchanges) {
    const std::string answer = hex(bench.say(each.host));
    EXPECT_EQ(answer, each.device) << each.name;
    if (is_told) {
      std::printf("%-34s host   %s\n%-34s device %s\n%-34s manual %s\n", each.name.c_str(), each.host.c_str(),
                  "", answer.c_str(), "", each.device.c_str());
    }
  }
}

}  // namespace slamsensor::tools
