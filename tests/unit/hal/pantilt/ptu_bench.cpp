#include "tests/unit/hal/pantilt/ptu_bench.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace slamsensor::tests {
namespace {

using hal::Stamp;

constexpr double kArcsec = 185.1428;  // as the script tells

}  // namespace

PtuBench::PtuBench(hal::PtuConfig config) : unit(link) {
  link.set_now(now);
  link.set_up(true);
  auto made = hal::PtuDriver::create(config, link);
  EXPECT_TRUE(made.has_value());
  driver = std::move(*made);
}

bool PtuBench::run(Stamp length, const std::function<bool()>& until) {
  const Stamp end = now + length;
  while (now < end) {
    now += period;
    link.set_now(now);
    driver->step(now);
    for (const ScriptedLink::Written& written : link.take_writes()) {
      unit.on_write(written);
    }
    if (until()) {
      return true;
    }
  }
  return until();
}

bool PtuBench::run_until_ready(Stamp length) {
  return run(length, [this] { return driver->state() == hal::DeviceState::Ready; });
}

std::vector<hal::AxisSample> PtuBench::take() {
  std::vector<hal::AxisSample> samples(hal::kAxisSamplesMax);
  samples.resize(driver->take(samples));
  return samples;
}

std::vector<hal::AxisSample> PtuBench::sweep(hal::Axis axis, int target, double speed_ps) {
  static_cast<void>(take());
  EXPECT_EQ(driver->move(axis, rad(target), rad(speed_ps)), hal::MoveStatus::Accepted);
  std::vector<hal::AxisSample> samples;
  const auto collect = [&] {
    for (const hal::AxisSample& sample : take()) {
      if (sample.axis == axis) {
        samples.push_back(sample);
      }
    }
  };
  const bool begun = run(std::chrono::seconds(3), [&] {
    collect();
    return driver->axis(axis).moving;
  });
  EXPECT_TRUE(begun);
  run(std::chrono::seconds(20), [&] {
    collect();
    return !driver->axis(axis).moving;
  });
  return samples;
}

std::uint64_t PtuBench::counter(std::string_view name) const {
  for (const hal::Counter& counter : driver->counters()) {
    if (counter.name == name) {
      return counter.value;
    }
  }
  ADD_FAILURE() << "no counter " << name;
  return 0;
}

double PtuBench::rad(double positions) const {
  return positions * kArcsec / 3600.0 * std::numbers::pi / 180.0;
}

void expect_true(const std::vector<hal::AxisSample>& samples, const PtuScript& unit, double position_rad) {
  for (const hal::AxisSample& sample : samples) {
    const char axis = sample.axis == hal::Axis::Pan ? 'P' : 'T';
    const int position = static_cast<int>(std::lround(sample.position_rad / position_rad));
    const int before = unit.position(axis, sample.stamp - sample.half_width - Stamp(1'000'000));
    const int after = unit.position(axis, sample.stamp + sample.half_width + Stamp(1'000'000));
    EXPECT_GE(position, std::min(before, after)) << "at " << sample.stamp.count();
    EXPECT_LE(position, std::max(before, after)) << "at " << sample.stamp.count();
  }
}

void expect_set_up(const PtuBench& bench) {
  EXPECT_EQ(bench.driver->state(), hal::DeviceState::Ready);
  EXPECT_EQ(bench.driver->problem(), "");
  EXPECT_FALSE(bench.unit.echo);
  EXPECT_FALSE(bench.unit.verbose);
  EXPECT_TRUE(bench.unit.limits);
  EXPECT_FALSE(bench.unit.slaved);
  EXPECT_FALSE(bench.unit.velocity);
  const hal::AxisInfo& pan = bench.driver->info().pan;
  EXPECT_NEAR(pan.min_rad, bench.rad(-3090), 1e-12);
  EXPECT_NEAR(pan.max_rad, bench.rad(3090), 1e-12);
  EXPECT_NEAR(pan.resolution_rad, bench.rad(1), 1e-15);
  EXPECT_NEAR(pan.speed_min_radps, bench.rad(31), 1e-12);
  EXPECT_NEAR(pan.speed_max_radps, bench.rad(2902), 1e-12);
  EXPECT_NEAR(pan.dynamics.base_speed_radps, bench.rad(1000), 1e-12);
  EXPECT_NEAR(pan.dynamics.acceleration_radps2, bench.rad(2000), 1e-12);
  EXPECT_NEAR(bench.driver->info().tilt.min_rad, bench.rad(-907), 1e-12);
  EXPECT_NEAR(bench.driver->info().tilt.max_rad, bench.rad(604), 1e-12);
  for (const std::string& command : bench.unit.heard) {
    EXPECT_THAT(command, testing::Not(testing::StartsWith("DS")));
    EXPECT_FALSE(command.size() > 2 && std::string("UABL").find(command[1]) != std::string::npos &&
                 (command[0] == 'P' || command[0] == 'T'))
        << command;
  }
}

}  // namespace slamsensor::tests
