#include "tools/emulator/make_ptu.hpp"

namespace slamsensor::tools {
namespace {

PtuKind kind_of(PanTiltModel unit) noexcept {
  switch (unit) {
    case PanTiltModel::D46_70:
      return PtuKind::D46_70;
    case PanTiltModel::E46_17_5:
      return PtuKind::E46_17_5;
    case PanTiltModel::D300E:
    case PanTiltModel::FastE:
      return PtuKind::D300E;
    case PanTiltModel::D46_17_5:
    case PanTiltModel::CanOpen:
      break;
  }
  return PtuKind::D46_17_5;
}

/// 321 deg/s reached at once: the base speed is the highest.
void make_fast(PtuAxisModel& axis) noexcept {
  constexpr long kFastest = 50'000;  // positions/s
  axis.base_speed = kFastest;
  axis.upper_speed = kFastest;
  axis.upper_speed_max = kFastest;
}

}  // namespace

PtuSettings ptu_settings_of(const PtuProfile& profile) {
  PtuSettings settings = ptu_settings(kind_of(profile.unit));
  if (profile.unit == PanTiltModel::FastE) {
    settings.model.name = "FAST-E";
    make_fast(settings.model.pan);
    make_fast(settings.model.tilt);
  }
  settings.begin = profile.begin == DeviceBegin::Ready ? PtuBegin::Ready : PtuBegin::PowerUp;
  settings.factory_baud = profile.baud;
  settings.reply_latency = {hal::from_seconds(profile.reply_latency_s),
                            hal::from_seconds(profile.reply_jitter_s)};
  settings.position_latency = hal::from_seconds(profile.position_age_s);
  settings.boot_time = hal::from_seconds(profile.boot_s);
  settings.reset_time = hal::from_seconds(profile.reset_s);
  return settings;
}

CanopenHeadSettings canopen_settings_of(const PtuProfile& profile) {
  CanopenHeadSettings settings = canopen_head_settings();
  for (DriveSettings* const axis : {&settings.pan, &settings.tilt}) {
    axis->begin = profile.begin;
    axis->memory = profile.encoder;
    if (profile.encoder == DriveMemory::Incremental) {
      axis->home_offset = axis->lower_limit - axis->switch_margin;  // as homing by method 17 needs it
    }
    axis->boot_time = hal::from_seconds(profile.boot_s);
    axis->sdo_latency = {hal::from_seconds(profile.reply_latency_s),
                         hal::from_seconds(profile.reply_jitter_s)};
    axis->sync_latch = -hal::from_seconds(profile.position_age_s);
  }
  return settings;
}

}  // namespace slamsensor::tools
