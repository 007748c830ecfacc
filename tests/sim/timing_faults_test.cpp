// Faults of time, through bytes, drivers, scans and SLAM, in simulated time: readings that arrive late in a
// burst, a rangefinder off its rate, a pan-tilt unit whose replies come late. Wrong fixes (1 m, 2 deg) must
// be none before, during and for two minutes after; printed beside them are the shares of scans fixed and how
// far the pan of the readings was from the truth, which is the error of the stamps times the speed.
#include "firmware/pipeline.hpp"
#include "hal/transport/byte_link.hpp"
#include "tests/support/source_tree.hpp"
#include "tools/drive/byte_drive.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/eval/evaluation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {
namespace {

/// A line on which somebody sits: what he lets through of what has arrived, and when.
class TamperedLink final : public hal::ByteLink {
 public:
  bool is_stalled = false;                          // the host reads nothing
  hal::Stamp late{};                                // by which bytes come later
  std::function<int(std::uint64_t record)> copies;  // of each record of a LightWare device
  std::function<std::size_t()> noise;               // bytes of noise before each record

  TamperedLink(hal::ByteLink& link, InProcessHead& head) : link_(link), head_(head) {}

  void service(hal::Stamp now) noexcept override { link_.service(now); }
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return link_.epoch(); }
  [[nodiscard]] bool is_up() const noexcept override { return link_.is_up(); }
  [[nodiscard]] std::string_view problem() const noexcept override { return link_.problem(); }
  [[nodiscard]] hal::LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override {
    return link_.write(bytes);
  }
  hal::LinkStatus set_baud(std::uint32_t baud) noexcept override { return link_.set_baud(baud); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return link_.baud(); }
  void discard_input() noexcept override {
    link_.discard_input();
    passed_.clear();
  }

  [[nodiscard]] hal::ByteRead read(std::span<std::uint8_t> into) noexcept override {
    if (is_stalled) {
      return {};
    }
    std::array<std::uint8_t, 512> got{};
    for (hal::ByteRead bytes = link_.read(got); bytes.status == hal::LinkStatus::Ok;
         bytes = link_.read(got)) {
      for (const std::uint8_t byte : std::span(got).first(bytes.count)) {
        take(byte);
      }
    }
    hal::ByteRead out;
    while (out.count < into.size() && !passed_.empty() && passed_.front().due <= head_.now()) {
      into[out.count++] = passed_.front().byte;
      passed_.pop_front();
    }
    out.status = out.count > 0 ? hal::LinkStatus::Ok : hal::LinkStatus::Busy;
    out.stamp = head_.now();
    return out;
  }

 private:
  struct Passed {
    std::uint8_t byte;
    hal::Stamp due;
  };

  void pass(std::uint8_t byte) { passed_.push_back({byte, head_.now() + late}); }

  /// 0xAA, two bytes with the length of what follows them in their upper ten bits, that, and a CRC of two.
  void take(std::uint8_t byte) {
    if (!copies && !noise) {
      return pass(byte);
    }
    record_.push_back(byte);
    if (record_[0] != 0xAA) {
      pass(byte);
      record_.clear();
      return;
    }
    if (record_.size() < 3) {
      return;
    }
    const std::size_t length = static_cast<std::size_t>(record_[1] | record_[2] << 8) >> 6;
    if (record_.size() < 3 + length + 2) {
      return;
    }
    for (std::size_t i = noise ? noise() : 0; i > 0; --i) {
      pass(static_cast<std::uint8_t>(i * 73 + records_));
    }
    for (int copy = copies ? copies(records_) : 1; copy > 0; --copy) {
      for (const std::uint8_t part : record_) {
        pass(part);
      }
    }
    ++records_;
    record_.clear();
  }

  hal::ByteLink& link_;
  InProcessHead& head_;
  std::deque<Passed> passed_;
  std::vector<std::uint8_t> record_;
  std::uint64_t records_ = 0;
};

using std::chrono::milliseconds;

enum class Stretch : std::uint8_t { Before, During, After };

/// Scans of one stretch.
struct Tally {
  double seconds = 0.0;
  int scans = 0;
  int fixes = 0;
  int wrong = 0;
  double pan_rms_rad = 0.0;  // greatest of a scan
};

class TimingRun {
 public:
  explicit TimingRun(firmware::SensorHeadConfig config) {
    auto scenario = load_scenario(tests::source_tree() / "tests/daemon/park.toml");
    EXPECT_TRUE(scenario) << scenario.error().message;
    const firmware::HeadConfig host = head_config(scenario->head);
    auto drive = ByteDrive::create(*scenario, config, host, [this](InProcessHead& head) {
      pan_tilt = std::make_unique<TamperedLink>(*head.ptu_bytes(), head);
      rangefinder = std::make_unique<TamperedLink>(*head.rangefinder_bytes(), head);
      return firmware::HeadLinks{pan_tilt.get(), nullptr, rangefinder.get(), nullptr};
    });
    EXPECT_TRUE(drive) << drive.error().message;
    drive_ = std::move(*drive);
  }

  std::unique_ptr<TamperedLink> pan_tilt;
  std::unique_ptr<TamperedLink> rangefinder;

  [[nodiscard]] ByteDrive& drive() { return *drive_; }

  /// Scans and localises for `seconds`.
  void run(Stretch stretch, double seconds) {
    Tally& tally = tallies_[static_cast<std::size_t>(stretch)];
    const double end_s = now_s() + seconds;
    while (now_s() < end_s) {
      const auto scan = drive_->next_scan(end_s - now_s());
      if (!scan) {
        break;
      }
      const core::Fix fix = pipeline_.process(scan->scanlines, {}, {});
      ++tally.scans;
      truth_.push_back({now_s(), scan->stand_W});
      if (fix.status == core::FixStatus::Fix) {
        trajectory_.push_back({now_s(), fix.pose_W});
        fixed_in_.push_back(stretch);
        ++tally.fixes;
        tally.pan_rms_rad = std::max(tally.pan_rms_rad, scan->pan.rms_rad);
      }
    }
    tally.seconds += seconds;
  }

  /// Prints and returns what came of it.
  std::array<Tally, 3> finish(const char* name) {
    const auto evaluation = evaluate(truth_, trajectory_);
    EXPECT_TRUE(evaluation && evaluation->first_fix) << name;
    if (evaluation && evaluation->first_fix) {
      for (std::size_t i = 0; i < evaluation->first_fix->fixes.size(); ++i) {
        tallies_[static_cast<std::size_t>(fixed_in_[i])].wrong +=
            evaluation->first_fix->fixes[i].is_wrong ? 1 : 0;
      }
    }
    std::printf("%-34s", name);
    for (const Tally& tally : tallies_) {
      std::printf(" | %5.0f s: %3d scans, %3d fixed, %d wrong, pan %.3f deg", tally.seconds, tally.scans,
                  tally.fixes, tally.wrong, tally.pan_rms_rad / core::kDegree);
    }
    std::printf(" | latency %.1f ms\n", drive_->sensor().latency().latency_s * 1e3);
    return tallies_;
  }

 private:
  [[nodiscard]] double now_s() const { return hal::to_seconds(drive_->head().now()); }

  std::unique_ptr<ByteDrive> drive_;
  firmware::Pipeline pipeline_{core::Config{}};
  std::array<Tally, 3> tallies_;
  std::vector<TimedPose> truth_;
  std::vector<TimedPose> trajectory_;
  std::vector<Stretch> fixed_in_;
};

/// Four scanlines of 220 deg at 300 deg/s.
firmware::SensorHeadConfig fast_scan() {
  firmware::SensorHeadConfig config;
  config.scan.pan_min_rad = -110.0 * core::kDegree;
  config.scan.pan_max_rad = 110.0 * core::kDegree;
  config.scan.tilt_min_rad = 0.0;
  config.scan.tilt_max_rad = 1.8 * core::kDegree;
  config.scan.tilt_step_rad = 0.6 * core::kDegree;
  config.scan.pan_speed_radps = 300.0 * core::kDegree;
  config.scan.tilt_speed_radps = 300.0 * core::kDegree;
  config.scan.settle_s = 0.02;
  config.scan.late_data_s = 0.05;
  config.scan.retry_s = 0.1;
  return config;
}

constexpr double kBefore_s = 40.0;
constexpr double kAfter_s = 120.0;

void expect_none_wrong(const std::array<Tally, 3>& tallies) {
  for (const Tally& tally : tallies) {
    EXPECT_EQ(tally.wrong, 0);
  }
  EXPECT_GT(tallies[0].fixes, 4);
  EXPECT_GT(tallies[2].fixes, 25) << "a scan takes about 3.5 s";
  EXPECT_GT(tallies[2].fixes, 0.95 * tallies[2].scans);
  EXPECT_LT(tallies[2].pan_rms_rad, 0.3 * core::kDegree);
}

TEST(Stalls, LeaveNoTrace) {
  for (const std::vector<double>& lengths_s : {std::vector{0.25}, {0.5}, {0.5, 0.3, 0.4}}) {
    TimingRun run(fast_scan());
    run.run(Stretch::Before, kBefore_s);
    for (const double length_s : lengths_s) {
      run.rangefinder->is_stalled = true;
      run.run(Stretch::During, length_s);
      run.rangefinder->is_stalled = false;
      run.run(Stretch::During, 1.0);
    }
    run.run(Stretch::After, kAfter_s);
    const std::string name = std::to_string(lengths_s.size()) + " stalls, the first of " +
                             std::to_string(lengths_s[0]).substr(0, 4) + " s";
    expect_none_wrong(run.finish(name.c_str()));
  }
}

TEST(RangefinderOffItsRate, IsReportedAndGivesNoFix) {
  const std::vector<std::pair<const char*, std::function<int(std::uint64_t)>>> faults = {
      {"every 20th record missing", [](std::uint64_t i) { return i % 20 == 0 ? 0 : 1; }},
      {"every 10th record doubled", [](std::uint64_t i) { return i % 10 == 0 ? 2 : 1; }}};
  for (const auto& [name, copies] : faults) {
    TimingRun run(fast_scan());
    run.run(Stretch::Before, kBefore_s);
    run.rangefinder->copies = copies;
    run.run(Stretch::During, 5.0);
    EXPECT_TRUE(run.drive().sensor().is_timing_in_doubt());
    std::printf("%s\n", std::string(run.drive().sensor().problem()).c_str());
    run.run(Stretch::During, 25.0);
    EXPECT_TRUE(run.drive().sensor().is_timing_in_doubt());
    run.rangefinder->copies = {};
    run.run(Stretch::During, 5.0);
    EXPECT_FALSE(run.drive().sensor().is_timing_in_doubt()) << "5 s after the end";
    run.run(Stretch::After, kAfter_s);
    const std::array<Tally, 3> tallies = run.finish(name);
    expect_none_wrong(tallies);
    EXPECT_LE(tallies[1].fixes, 4) << "before it is seen, and after the end";
  }
}

TEST(RangefinderOffItsRate, FromTheStartGivesNoFix) {
  TimingRun run(fast_scan());
  run.rangefinder->copies = [](std::uint64_t i) { return i % 20 == 0 ? 0 : 1; };
  run.run(Stretch::During, 60.0);
  EXPECT_TRUE(run.drive().sensor().is_timing_in_doubt());
  run.rangefinder->copies = {};
  run.run(Stretch::After, kAfter_s);
  const std::array<Tally, 3> tallies = run.finish("every 20th missing from the start");
  EXPECT_EQ(tallies[1].fixes, 0);
  EXPECT_EQ(tallies[2].wrong, 0);
  EXPECT_GT(tallies[2].fixes, 20);
}

TEST(Noise, IsOverSecondsAfterItsEnd) {
  TimingRun run(fast_scan());
  run.run(Stretch::Before, kBefore_s);
  run.rangefinder->noise = [] { return std::size_t{40}; };  // 1 MB in 5 s
  run.run(Stretch::During, 5.0);
  run.rangefinder->noise = {};
  run.run(Stretch::During, 5.0);
  run.run(Stretch::After, kAfter_s);
  expect_none_wrong(run.finish("1 MB of noise"));
}

TEST(LateReplies, GiveNoFixUntilTheLatencyIsFoundAnew) {
  for (const bool calibrates : {true, false}) {
    firmware::SensorHeadConfig config = fast_scan();
    if (!calibrates) {
      // As found by a run with it.
      TimingRun finder(fast_scan());
      finder.run(Stretch::Before, 20.0);
      config.latency.self_calibration = false;
      config.latency.initial_s = finder.drive().sensor().latency().latency_s;
      config.scan.calibration_lines = 0;
    }
    TimingRun run(config);
    run.run(Stretch::Before, kBefore_s);
    run.pan_tilt->late = milliseconds(50);
    run.run(Stretch::During, kAfter_s);
    std::printf("%s\n", std::string(run.drive().sensor().problem()).c_str());
    run.pan_tilt->late = {};
    run.run(Stretch::During, 20.0);
    run.run(Stretch::After, kAfter_s);
    expect_none_wrong(run.finish(calibrates ? "replies 50 ms late" : "replies 50 ms late, fixed latency"));
  }
}

}  // namespace
}  // namespace slamsensor::tools
