#include "tests/rt/taped_head.hpp"

#include "tools/drive/byte_drive.hpp"
#include "tools/emulator/emulated_head.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <utility>
#include <variant>

namespace slamsensor::tests {
namespace {

constexpr hal::Stamp kStep = std::chrono::milliseconds(1);
constexpr double kSide_rad = 0.6;
constexpr double kSpeed_radps = 0.8;

}  // namespace

HeadRun::HeadRun(const firmware::HeadLinks& links, const tools::HeadProfile& profile) {
  auto made = firmware::make_head_drivers(tools::head_config(profile), links);
  if (!made) {
    throw std::runtime_error(made.error().message);
  }
  drivers_ = std::move(*made);
}

void DriversRun::step(hal::Stamp now) noexcept {
  hal::PanTilt& unit = *drivers().pan_tilt;
  unit.step(now);
  drivers().rangefinder->step(now);
  if (unit.state() == hal::DeviceState::Ready && !unit.axis(hal::Axis::Pan).moving &&
      unit.move(hal::Axis::Pan, side_ * kSide_rad, kSpeed_radps) == hal::MoveStatus::Accepted) {
    side_ = -side_;
  }
  std::array<hal::AxisSample, 16> places;
  positions += unit.take(places);
  std::array<hal::RangeSample, 256> ranges;
  readings += drivers().rangefinder->take(ranges);
}

ScanRun::ScanRun(const firmware::HeadLinks& links, const tools::HeadProfile& profile,
                 const firmware::SensorHeadConfig& config)
    : HeadRun(links, profile),
      sensor_(std::make_unique<firmware::SensorHead>(*drivers().pan_tilt, *drivers().rangefinder, config)) {
}

void ScanRun::step(hal::Stamp now) noexcept {
  sensor_->step(now);
  while (const auto event = sensor_->take()) {
    if (const auto* const line = std::get_if<firmware::Scanline>(&*event)) {
      ++lines;
      readings += line->readings.size();
    }
    scans += std::holds_alternative<firmware::ScanEnded>(*event) ? 1 : 0;
  }
}

HeadTape record(const tools::Scenario& scenario, std::size_t steps, const MakeRun& make) {
  auto made = tools::InProcessHead::create(scenario);
  if (!made) {
    throw std::runtime_error(made.error().message);
  }
  tools::InProcessHead& head = **made;
  HeadTape tape{.steps = steps};
  const auto taped_bytes = [](hal::ByteLink* link, LinkTape& onto) {
    return link != nullptr ? std::make_unique<RecordingByteLink>(*link, onto) : nullptr;
  };
  const auto taped_can = [](hal::CanLink* link, LinkTape& onto) {
    return link != nullptr ? std::make_unique<RecordingCanLink>(*link, onto) : nullptr;
  };
  const auto unit_bytes = taped_bytes(head.ptu_bytes(), tape.pan_tilt);
  const auto unit_can = taped_can(head.ptu_can(), tape.pan_tilt);
  const auto finder_bytes = taped_bytes(head.rangefinder_bytes(), tape.rangefinder);
  const auto finder_can = taped_can(head.rangefinder_can(), tape.rangefinder);
  const auto run = make({unit_bytes.get(), unit_can.get(), finder_bytes.get(), finder_can.get()});
  for (std::size_t i = 0; i < steps; ++i) {
    head.advance(head.now() + kStep);
    run->step(head.now());
  }
  return tape;
}

void replay(const HeadTape& tape, HeadRun& run) noexcept {
  hal::Stamp now{};
  for (std::size_t i = 0; i < tape.steps; ++i) {
    now += kStep;
    run.step(now);
  }
}

void expect_real_time(const char* name, std::size_t stack_max_bytes,
                      const std::function<Cost()>& replay_once) {
  Cost cost = replay_once();
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: all was stepped, but a sanitizer's heap and stack are not those of the product";
  }
  EXPECT_EQ(cost.heap_calls, 0U);
  EXPECT_LT(cost.stack_bytes, stack_max_bytes);
  std::printf("%-22s heap calls %llu, page faults %llu, stack %zu bytes\n", name,
              static_cast<unsigned long long>(cost.heap_calls),
              static_cast<unsigned long long>(cost.page_faults), cost.stack_bytes);
  if (!hold_memory()) {
    GTEST_SKIP() << "SKIPPED: memory can neither be locked (ulimit -l) nor populated (Linux 5.14) here";
  }
  // The kernel may take a page away for its own reasons (migration, compaction), hence three tries.
  for (int attempt = 0; attempt < 2 && cost.page_faults > 0; ++attempt) {
    cost.page_faults = std::min(cost.page_faults, replay_once().page_faults);
  }
  EXPECT_EQ(cost.page_faults, 0U);
}

ReplayedLinks::ReplayedLinks(const HeadTape& tape, const tools::HeadProfile& profile)
    : pan_tilt_bytes_(tape.pan_tilt),
      rangefinder_bytes_(tape.rangefinder),
      pan_tilt_can_(tape.pan_tilt),
      rangefinder_can_(tape.rangefinder) {
  if (tools::is_on_bus(profile.ptu.unit)) {
    links_.pan_tilt_can = &pan_tilt_can_;
  } else {
    links_.pan_tilt_bytes = &pan_tilt_bytes_;
  }
  if (tools::is_on_bus(profile.rangefinder.unit)) {
    links_.rangefinder_can = &rangefinder_can_;
  } else {
    links_.rangefinder_bytes = &rangefinder_bytes_;
  }
}

std::size_t ReplayedLinks::beyond() const noexcept {
  return pan_tilt_bytes_.beyond() + rangefinder_bytes_.beyond() + pan_tilt_can_.beyond() +
         rangefinder_can_.beyond();
}

}  // namespace slamsensor::tests
