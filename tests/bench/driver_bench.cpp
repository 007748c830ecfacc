// Drivers at the rates that their protocols carry, each on a real serial port: a pseudo-terminal with the
// emulated device at its other end, in real time. Prints a table: what came through, what was lost, the
// driver's share of a processor, and how well the emulator kept its own times.
#include "hal/clock.hpp"
#include "hal/pantilt/ptu_driver.hpp"
#include "hal/rangefinder/benewake_driver.hpp"
#include "hal/rangefinder/lwnx_driver.hpp"
#include "hal/rangefinder/point_laser.hpp"
#include "hal/transport/serial_port.hpp"
#include "tests/support/busy_head.hpp"
#include "tools/emulator/rangefinder/emulated_point_laser.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace slamsensor::bench {
namespace {

using namespace std::chrono_literals;
using hal::Stamp;
using tools::RangefinderModel;

constexpr Stamp kStep = 1ms;
constexpr Stamp kPatience = 60s;
constexpr Stamp kWarmUp = 1s;
constexpr std::uint32_t kPtuBaud = 9600;

struct Case {
  const char* name;
  RangefinderModel unit;
  double rate_hz;
  std::uint32_t baud;
  std::function<tl::expected<std::unique_ptr<hal::Rangefinder>, hal::InitError>(const Case& c,
                                                                                hal::ByteLink& link)>
      make;
  bool is_packed = false;  // the point laser's binary record of two bytes
};

double thread_cpu_s() {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

/// Calls `step` every millisecond until `end` or until it says that it is enough; the processor time that
/// passed in it.
double run_until(Stamp end, const std::function<bool(Stamp now)>& step) {
  double cpu_s = 0.0;
  for (Stamp wake = hal::monotonic_now(); wake < end; wake += kStep) {
    const timespec at = {static_cast<std::time_t>(wake.count() / 1'000'000'000),
                         static_cast<long>(wake.count() % 1'000'000'000)};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
    const double before_s = thread_cpu_s();
    const bool is_enough = step(hal::monotonic_now());
    cpu_s += thread_cpu_s() - before_s;
    if (is_enough) {
      break;
    }
  }
  return cpu_s;
}

std::uint64_t counter(std::span<const hal::Counter> counters, std::string_view name) {
  for (const hal::Counter& counter : counters) {
    if (counter.name == name) {
      return counter.value;
    }
  }
  return 0;
}

std::unique_ptr<hal::SerialPort> open_port(const std::string& path, std::uint32_t baud) {
  hal::SerialConfig config;
  config.path = path;
  config.line.baud = baud;
  return std::move(hal::SerialPort::create(config).value());
}

/// The devices of the scenario, but the laser with its binary record.
tl::expected<tools::HeadDevices, tools::WorldError> make_packed(const tools::Scenario& scenario,
                                                                tools::RangeScene& scene) {
  auto devices = tools::make_head_devices(scenario, scene);
  if (devices) {
    tools::PointSettings settings = tools::lds70a_settings();
    settings.format.coding = tools::PointCoding::SevenBit;
    settings.format.units_per_m = 50.0;  // 14 bits reach 327 m
    settings.baud = scenario.head.rangefinder.baud;
    settings.rate_hz = scenario.head.rangefinder.rate_hz;
    auto laser = std::make_unique<tools::EmulatedPointLaser>(settings, *devices->rangefinder_port, scene);
    devices->rangefinder_port->attach(*laser);
    devices->rangefinder = std::move(laser);
  }
  return devices;
}

tools::Scenario scenario_of(const Case& c) {
  tools::Scenario scenario;
  scenario.head.ptu.begin = tools::DeviceBegin::Ready;
  scenario.head.rangefinder.unit = c.unit;
  scenario.head.rangefinder.rate_hz = c.rate_hz;
  scenario.head.rangefinder.baud = c.baud;
  scenario.drive.stands = 1;
  return scenario;
}

void print_row(const char* name, std::uint32_t baud, double rate_hz, double got_hz, std::uint64_t lost,
               double cpu_share, tests::BusyHead& head) {
  head.stop();
  std::printf("| %s | %u | %.0f | %.1f | %llu | %.2f | %.2f | %.2f | %.2f |\n", name, baud, rate_hz, got_hz,
              static_cast<unsigned long long>(lost), 100.0 * cpu_share, 100.0 * head.cpu_share(),
              1e3 * hal::to_seconds(head.lateness().within(0.999)),
              1e3 * hal::to_seconds(head.lateness().worst()));
  std::fflush(stdout);
}

void measure(const Case& c, Stamp length) {
  tests::BusyHead head(scenario_of(c), c.is_packed ? make_packed : tools::make_head_devices);
  const auto port = open_port(head.finder_path(), c.baud);
  const auto driver = std::move(c.make(c, *port).value());
  std::size_t readings = 0;
  const auto step = [&](Stamp now) {
    driver->step(now);
    std::array<hal::RangeSample, 512> samples;
    readings += driver->take(samples);
    return false;
  };
  run_until(hal::monotonic_now() + kPatience, [&](Stamp now) {
    step(now);
    return driver->state() == hal::DeviceState::Ready;
  });
  run_until(hal::monotonic_now() + kWarmUp, step);
  const auto lost = [&] {
    return counter(driver->counters(), "readings_dropped") + counter(driver->counters(), "periods_missing") +
           counter(driver->counters(), "checksum_errors");
  };
  readings = 0;
  const std::uint64_t lost_before = lost();
  const Stamp begun = hal::monotonic_now();
  const double cpu_s = run_until(begun + length, step);
  const double took_s = hal::to_seconds(hal::monotonic_now() - begun);
  print_row(c.name, c.baud, driver->info().rate_hz, static_cast<double>(readings) / took_s,
            lost() - lost_before, cpu_s / took_s, head);
  if (driver->state() != hal::DeviceState::Ready) {
    std::printf("  (%s)\n", std::string(driver->problem()).c_str());
  }
}

/// The pan-tilt unit sweeps to and fro at the paper's speed.
void measure_ptu(const char* name, tools::PanTiltModel unit, std::uint32_t baud, Stamp length) {
  tools::Scenario scenario;
  scenario.head.ptu.unit = unit;
  scenario.head.ptu.begin = tools::DeviceBegin::Ready;
  scenario.head.ptu.baud = baud;
  scenario.drive.stands = 1;
  tests::BusyHead head(scenario);
  const auto port = open_port(head.unit_path(), baud);
  const hal::PtuConfig config;
  const auto driver = std::move(hal::PtuDriver::create(config, *port).value());
  std::size_t positions = 0;
  double side = 1.0;
  const auto step = [&](Stamp now) {
    driver->step(now);
    if (driver->state() == hal::DeviceState::Ready && !driver->axis(hal::Axis::Pan).moving &&
        driver->move(hal::Axis::Pan, side * 2.0, 0.89) == hal::MoveStatus::Accepted) {
      side = -side;
    }
    std::array<hal::AxisSample, 16> samples;
    positions += driver->take(samples);
    return false;
  };
  run_until(hal::monotonic_now() + kPatience, [&](Stamp now) {
    step(now);
    return driver->state() == hal::DeviceState::Ready;
  });
  run_until(hal::monotonic_now() + kWarmUp, step);
  positions = 0;
  const std::uint64_t lost_before = counter(driver->counters(), "timeouts");
  const Stamp begun = hal::monotonic_now();
  const double cpu_s = run_until(begun + length, step);
  const double took_s = hal::to_seconds(hal::monotonic_now() - begun);
  print_row(name, baud, config.poll_hz, static_cast<double>(positions) / took_s,
            counter(driver->counters(), "timeouts") - lost_before, cpu_s / took_s, head);
}

auto make_lwnx(const Case& c, hal::ByteLink& link) {
  hal::LwnxConfig config;
  config.baud = c.baud;
  config.rate_hz = c.rate_hz;
  config.mode = c.rate_hz >= 20'000.0 ? hal::LwnxMode::RawReadings : hal::LwnxMode::Readings;
  return hal::make_lwnx_rangefinder(config, link);
}

auto make_benewake(const Case& c, hal::ByteLink& link) {
  hal::BenewakeSerialConfig config;
  config.baud = c.baud;
  config.device.rate_hz = c.rate_hz;
  return hal::make_benewake_serial(config, link);
}

auto make_laser(const Case& c, hal::ByteLink& link) {
  hal::PointLaserConfig config = hal::astech_lds70a();
  config.baud = c.baud;
  config.rate_hz = c.rate_hz;
  if (c.is_packed) {
    config.record = hal::PointRecord::Packed7;
    config.unit_m = 0.02;
    config.codes = {{0, hal::Echo::None}};
    config.texts.clear();
  }
  return hal::make_point_laser(config, link);
}

int run(Stamp length) {
  std::printf("\n## Drivers on a pseudo-terminal, stepped every millisecond, %.0f s each\n\n",
              hal::to_seconds(length));
  std::printf(
      "| device | baud | asked Hz | came Hz | lost | driver CPU %% | emulator CPU %% | its bytes late: 99.9 "
      "%% "
      "within ms | worst ms |\n|---|---|---|---|---|---|---|---|---|\n");
  measure_ptu("PTU-46-17.5, polls", tools::PanTiltModel::D46_17_5, kPtuBaud, length);
  measure_ptu("fast E-series, polls", tools::PanTiltModel::FastE, 115'200, length);
  const std::array cases = {
      Case{"LightWare SF45, readings", RangefinderModel::Sf45, 1000.0, 921'600, make_lwnx},
      Case{"LightWare SF45, its fastest", RangefinderModel::Sf45, 5000.0, 921'600, make_lwnx},
      Case{"LightWare LW20, raw", RangefinderModel::Lw20, 20'000.0, 921'600, make_lwnx},
      Case{"Benewake TF03", RangefinderModel::Tf03, 1000.0, 115'200, make_benewake},
      Case{"Benewake TF03, its fastest", RangefinderModel::Tf03, 10'000.0, 1'000'000, make_benewake},
      Case{"LDS70A, decimal", RangefinderModel::Lds70a, 1000.0, 115'200, make_laser},
      Case{"LDS70A, 2 bytes", RangefinderModel::Lds70a, 10'000.0, 460'800, make_laser, true},
      Case{"LDS70A, 2 bytes", RangefinderModel::Lds70a, 20'000.0, 921'600, make_laser, true}};
  for (const Case& c : cases) {
    measure(c, length);
  }
  return 0;
}

}  // namespace
}  // namespace slamsensor::bench

// bench_driver [SECONDS of each device]; options of other benchmarks are passed over.
int main(int argc, char** argv) {
  const double seconds = argc > 1 && argv[1][0] != '-' ? std::strtod(argv[1], nullptr) : 10.0;
  return slamsensor::bench::run(slamsensor::hal::from_seconds(std::isfinite(seconds) ? seconds : 10.0));
}
