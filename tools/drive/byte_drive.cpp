#include "tools/drive/byte_drive.hpp"

#include "hal/rangefinder/point_laser.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace slamsensor::tools {
namespace {

constexpr std::int8_t kToLowerSwitch = 17;  // CiA 402, homing methods
constexpr double kRawRateHz = 20'000.0;     // LWNX devices send it in packets of raw readings alone

void set_pan_tilt(firmware::HeadConfig& config, const PtuProfile& profile) {
  if (!is_on_bus(profile.unit)) {
    return;
  }
  config.pan_tilt = firmware::PanTiltKind::Canopen;
  for (hal::CanopenAxisConfig* const axis : {&config.canopen.pan, &config.canopen.tilt}) {
    axis->scale = hal::CanopenScale::FromDrive;
    axis->speed_max_radps = 5.0;
    axis->homing_method = profile.encoder == DriveMemory::Incremental ? kToLowerSwitch : 0;
  }
}

void set_point_laser(firmware::HeadConfig& config, firmware::PointLaserPreset preset,
                     const RangefinderProfile& profile) {
  config.rangefinder = firmware::RangefinderKind::PointLaser;
  config.point_laser_preset = preset;
  config.point_laser = firmware::preset_config(preset);
  config.point_laser.baud = profile.baud;
  config.point_laser.rate_hz = profile.rate_hz;
}

void set_rangefinder(firmware::HeadConfig& config, const RangefinderProfile& profile) {
  switch (profile.unit) {
    case RangefinderModel::Lw20:
    case RangefinderModel::Sf30d:
    case RangefinderModel::Sf45:
    case RangefinderModel::Grf500:
      config.rangefinder = firmware::RangefinderKind::Lwnx;
      config.lwnx.baud = profile.baud;
      config.lwnx.rate_hz = profile.rate_hz;
      config.lwnx.mode = profile.rate_hz >= kRawRateHz ? hal::LwnxMode::RawReadings : hal::LwnxMode::Readings;
      return;
    case RangefinderModel::Tf03:
    case RangefinderModel::Tf03Can:
      config.rangefinder = is_on_bus(profile.unit) ? firmware::RangefinderKind::BenewakeCan
                                                   : firmware::RangefinderKind::BenewakeSerial;
      config.benewake_serial.device.rate_hz = profile.rate_hz;
      config.benewake_serial.baud = profile.baud;
      return;
    case RangefinderModel::Lds70a:
      set_point_laser(config, firmware::PointLaserPreset::AstechLds70a, profile);
      return;
    case RangefinderModel::LaserAceIm:
      break;
  }
  set_point_laser(config, firmware::PointLaserPreset::MdlLaserAceImHr, profile);
}

}  // namespace

firmware::HeadConfig head_config(const HeadProfile& profile) {
  firmware::HeadConfig config;
  set_pan_tilt(config, profile.ptu);
  set_rangefinder(config, profile.rangefinder);
  return config;
}

tl::expected<HeadDrivers, WorldError> make_head_drivers(const HeadProfile& profile, InProcessHead& head) {
  return firmware::make_head_drivers(head_config(profile), {head.ptu_bytes(), head.ptu_can(),
                                                            head.rangefinder_bytes(), head.rangefinder_can()})
      .map_error([](const hal::InitError& error) { return WorldError{error.message}; });
}

namespace {

constexpr Stamp kStep = std::chrono::milliseconds(1);

// Truth older than this belongs to readings that no line has claimed.
constexpr Stamp kTruthAge = std::chrono::seconds(30);
constexpr std::size_t kTruthMax = 1'000'000;

// A driver smooths the times of readings that were sent late by chance, and may take all of a reading's
// period for its jitter: shots are looked for this many quarters of a period around the mean delay.
constexpr int kQuartersMax = 16;

/// Whether a reading can be what the device made of the shot.
bool agree(const core::Reading& reading, const ShotTruth& shot) {
  const bool is_target = shot.target.kind == TargetKind::Target;
  return reading.has_return() ? is_target && std::abs(reading.range_m - shot.target.range_m) < 0.02
                              : !is_target;
}

/// Mean time from shot to wire. Shots are evenly spaced in time, what goes out is not.
Stamp mean_delay(const std::vector<ShotTruth>& truth) {
  Stamp sum{};
  for (const ShotTruth& shot : truth) {
    sum += shot.on_wire - shot.measured;
  }
  return truth.empty() ? Stamp{} : sum / std::ssize(truth);
}

/// The shot of each reading of a line had each gone out `delay` after it was fired, null where the ranges
/// disagree.
std::vector<const ShotTruth*> delayed_shots(const firmware::Scanline& line,
                                            const std::vector<ShotTruth>& truth, Stamp delay) {
  std::vector<const ShotTruth*> shots;
  std::size_t shot = 0;
  for (std::size_t i = 0; i < line.stamps.size(); ++i) {
    const Stamp measured = line.stamps[i] - delay;
    while (shot + 1 < truth.size() && std::chrono::abs(truth[shot + 1].measured - measured) <=
                                          std::chrono::abs(truth[shot].measured - measured)) {
      ++shot;
    }
    shots.push_back(agree(line.readings[i], truth[shot]) ? &truth[shot] : nullptr);
  }
  return shots;
}

/// The shot of each reading of a line, null where it is not known: those of the delay at which most ranges
/// agree.
std::vector<const ShotTruth*> shots_of(const firmware::Scanline& line, const std::vector<ShotTruth>& truth) {
  std::vector<const ShotTruth*> best;
  if (truth.size() < 2) {
    return best;
  }
  const Stamp quarter = (truth.back().measured - truth.front().measured) / (4 * (std::ssize(truth) - 1));
  std::ptrdiff_t best_count = -1;
  for (int quarters = -kQuartersMax; quarters <= kQuartersMax; ++quarters) {
    auto shots = delayed_shots(line, truth, mean_delay(truth) + quarters * quarter);
    const auto count = std::ssize(shots) - std::count(shots.begin(), shots.end(), nullptr);
    if (count > best_count) {
      best_count = count;
      best = std::move(shots);
    }
  }
  return best;
}

}  // namespace

tl::expected<std::unique_ptr<ByteDrive>, WorldError> ByteDrive::create(
    Scenario scenario, const firmware::SensorHeadConfig& config) {
  const firmware::HeadConfig host = head_config(scenario.head);
  return create(std::move(scenario), config, host, [](InProcessHead& head) {
    return firmware::HeadLinks{head.ptu_bytes(), head.ptu_can(), head.rangefinder_bytes(),
                               head.rangefinder_can()};
  });
}

tl::expected<std::unique_ptr<ByteDrive>, WorldError> ByteDrive::create(
    Scenario scenario, const firmware::SensorHeadConfig& config, const firmware::HeadConfig& host,
    const Through& through) {
  scenario.change = StandChange::OnScanEnd;
  scenario.truth_max = kTruthMax;
  auto head = InProcessHead::create(scenario);
  if (!head) {
    return tl::unexpected(head.error());
  }
  auto drivers = firmware::make_head_drivers(host, through(**head));
  if (!drivers) {
    return tl::unexpected(WorldError{drivers.error().message});
  }
  return std::unique_ptr<ByteDrive>(new ByteDrive(std::move(*head), std::move(*drivers), config));
}

ByteDrive::ByteDrive(std::unique_ptr<InProcessHead> head, HeadDrivers drivers,
                     const firmware::SensorHeadConfig& config)
    : head_(std::move(head)),
      drivers_(std::move(drivers)),
      sensor_(std::make_unique<firmware::SensorHead>(*drivers_.pan_tilt, *drivers_.rangefinder, config)) {
}

std::optional<DrivenScan> ByteDrive::next_scan(double limit_s) {
  const Stamp end = head_->now() + hal::from_seconds(limit_s);
  while (head_->now() < end) {
    if (step()) {
      PanErrors& pan = scan_.pan;
      const double count = static_cast<double>(std::max<std::size_t>(pan.readings, 1));
      pan.mean_rad = pan_error_sum_ / count;
      pan.rms_rad = std::sqrt(pan_error_squares_ / count);
      scan_.stand_W = head_->head().visits().back().visit.pose_W;
      static_cast<void>(head_->head().next_stand());
      return std::move(scan_);
    }
  }
  return std::nullopt;
}

void ByteDrive::run(double seconds) {
  const Stamp end = head_->now() + hal::from_seconds(seconds);
  while (head_->now() < end) {
    static_cast<void>(step());
  }
}

bool ByteDrive::step() {
  head_->advance(head_->now() + kStep);
  sensor_->step(head_->now());
  bool has_ended = false;
  while (const auto event = sensor_->take()) {
    if (std::holds_alternative<firmware::ScanBegun>(*event) ||
        std::holds_alternative<firmware::ScanAborted>(*event)) {
      scan_ = {};
      pan_error_sum_ = pan_error_squares_ = 0.0;
    } else if (const auto* line = std::get_if<firmware::Scanline>(&*event)) {
      add(*line);
    } else if (const auto* ended = std::get_if<firmware::ScanEnded>(&*event)) {
      scan_.ended = *ended;
      has_ended = true;
    }
  }
  return has_ended;
}

void ByteDrive::add(const firmware::Scanline& line) {
  scan_.scanlines.emplace_back(line.readings.begin(), line.readings.end());
  compare(line);
}

void ByteDrive::compare(const firmware::Scanline& line) {
  const auto fresh = head_->head().take_truth();
  truth_.insert(truth_.end(), fresh.begin(), fresh.end());
  const double sign = line.direction == firmware::SweepDirection::Leftwards ? 1.0 : -1.0;
  const std::vector<const ShotTruth*> shots = shots_of(line, truth_);
  for (std::size_t i = 0; i < shots.size(); ++i) {
    if (shots[i] == nullptr) {
      continue;
    }
    const double error_rad = sign * (line.readings[i].pan_rad - shots[i]->angles.pan_rad);
    ++scan_.pan.readings;
    pan_error_sum_ += error_rad;
    pan_error_squares_ += error_rad * error_rad;
    scan_.pan.worst_rad = std::max(scan_.pan.worst_rad, std::abs(error_rad));
  }
  const auto kept = std::find_if(truth_.begin(), truth_.end(), [&](const ShotTruth& old) {
    return old.on_wire > head_->now() - kTruthAge;
  });
  truth_.erase(truth_.begin(), kept);
}

}  // namespace slamsensor::tools
