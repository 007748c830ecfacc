#pragma once

#include "firmware/scan/sensor_head.hpp"
#include "tests/support/fake_head.hpp"

#include <cmath>
#include <optional>
#include <variant>
#include <vector>

namespace slamsensor::firmware {

/// Posts at uneven bearings before a far wall; what is above the horizon is open sky between them.
inline hal::RangeSample posts(double pan_rad, double tilt_rad, hal::Stamp) {
  const double cell = std::floor((pan_rad + 4.0) / 0.11);
  const double shade = std::abs(std::fmod(std::sin(cell * 12.9898) * 43758.5453, 1.0));
  const double middle_rad = (cell + 0.2 + 0.6 * shade) * 0.11 - 4.0;
  if (std::abs(pan_rad - middle_rad) < 0.004 + 0.008 * shade) {
    return {{}, 8.0 + 30.0 * std::fmod(shade * 7.0, 1.0), 0.0, hal::Echo::Return};
  }
  return tilt_rad > 0.0 ? hal::RangeSample{} : hal::RangeSample{{}, 90.0, 0.0, hal::Echo::Return};
}

/// The same in every direction, but for the grain that a real surface has.
inline hal::RangeSample plain(double, double, hal::Stamp at) {
  return {{}, 50.0 + 1e-6 * static_cast<double>(at.count() / 1'000'000 % 7), 0.0, hal::Echo::Return};
}

/// A short scan: +-60 deg, three lines, two lines of calibration.
inline SensorHeadConfig short_scan() {
  SensorHeadConfig config;
  config.scan.pan_min_rad = -1200 * kPaperStep_rad;
  config.scan.pan_max_rad = 1200 * kPaperStep_rad;
  config.scan.tilt_min_rad = -10 * kPaperStep_rad;
  config.scan.tilt_max_rad = 10 * kPaperStep_rad;
  config.scan.calibration_lines = 2;
  return config;
}

/// What came out of a head.
struct Taken {
  std::vector<ScanBegun> begun;
  std::vector<ScanEnded> ended;
  std::vector<ScanAborted> aborted;
  std::vector<Scanline> lines;                       // their spans are not valid any more
  std::vector<std::vector<core::Reading>> readings;  // of each line

  [[nodiscard]] const char* problem_with_order() const {
    return begun.size() == ended.size() + aborted.size() || begun.size() == ended.size() + aborted.size() + 1
               ? nullptr
               : "scans ended that had not begun";
  }
};

/// A head on fakes, with a clock.
class HeadRig {
 public:
  HeadRig(const SensorHeadConfig& config, const tests::FakePanTiltConfig& unit_config,
          const tests::FakeRangefinderConfig& range_config, tests::Scene scene)
      : unit(unit_config),
        rangefinder(range_config, unit, std::move(scene)),
        head(unit, rangefinder, config) {}

  /// Steps every millisecond for so long, or until as many scans have ended.
  void run(double seconds, std::size_t scans_ended = 1'000'000) {
    const hal::Stamp end = now + hal::from_seconds(seconds);
    while (now < end && taken.ended.size() < scans_ended) {
      now += std::chrono::milliseconds(1);
      head.step(now);
      while (const auto event = head.take()) {
        keep(*event);
      }
    }
  }

  tests::FakePanTilt unit;
  tests::FakeRangefinder rangefinder;
  SensorHead head;
  Taken taken;
  hal::Stamp now{};

 private:
  void keep(const HeadEvent& event) {
    if (const auto* begun = std::get_if<ScanBegun>(&event)) {
      taken.begun.push_back(*begun);
    } else if (const auto* ended = std::get_if<ScanEnded>(&event)) {
      taken.ended.push_back(*ended);
    } else if (const auto* aborted = std::get_if<ScanAborted>(&event)) {
      taken.aborted.push_back(*aborted);
    } else if (const auto* line = std::get_if<Scanline>(&event)) {
      taken.lines.push_back(*line);
      taken.readings.emplace_back(line->readings.begin(), line->readings.end());
    }
  }
};

}  // namespace slamsensor::firmware
