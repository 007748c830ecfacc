#include "tools/emulator/make_rangefinder.hpp"

#include "tools/emulator/rangefinder/emulated_lwnx.hpp"
#include "tools/emulator/rangefinder/emulated_point_laser.hpp"
#include "tools/emulator/rangefinder/emulated_tf03.hpp"
#include "tools/emulator/rangefinder/emulated_tf03_can.hpp"

namespace slamsensor::tools {
namespace {

using Made = std::unique_ptr<EmulatedSerialDevice>;

Delay record_delay(const RangefinderProfile& profile) noexcept {
  return {hal::from_seconds(profile.latency_s), hal::from_seconds(profile.jitter_s)};
}

Made make_lwnx(LwnxModel model, const RangefinderProfile& profile, ByteSink& sink, RangeScene& scene,
               std::uint64_t seed) {
  LwnxSettings settings;
  settings.product = lwnx_product(model);
  settings.begin = profile.begin;
  settings.baud = profile.baud;
  settings.delays.record = record_delay(profile);
  settings.crystal_ppm = profile.crystal_ppm;
  settings.seed = seed;
  set_rate(settings, profile.rate_hz);
  return std::make_unique<EmulatedLwnx>(settings, sink, scene);
}

Made make_point_laser(PointSettings settings, const RangefinderProfile& profile, ByteSink& sink,
                      RangeScene& scene, std::uint64_t seed) {
  settings.begin = profile.begin;
  settings.baud = profile.baud;
  settings.rate_hz = profile.rate_hz;
  settings.delays.record = record_delay(profile);
  settings.crystal_ppm = profile.crystal_ppm;
  settings.seed = seed;
  return std::make_unique<EmulatedPointLaser>(settings, sink, scene);
}

Tf03Settings tf03_settings_of(const RangefinderProfile& profile, std::uint64_t seed) {
  Tf03Settings settings = tf03_settings(BenewakeModel::Tf03);
  settings.begin = profile.begin;
  settings.saved.baud = profile.baud;
  settings.delays.record = record_delay(profile);
  settings.crystal_ppm = profile.crystal_ppm;
  settings.seed = seed;
  set_rate(settings, profile.rate_hz);
  return settings;
}

}  // namespace

std::unique_ptr<EmulatedCanDevice> make_can_rangefinder(const RangefinderProfile& profile, FrameSink& sink,
                                                        RangeScene& scene, std::uint64_t seed) {
  Tf03Settings settings = tf03_settings_of(profile, seed);
  settings.saved.wire = Tf03Wire::Can;
  return std::make_unique<EmulatedTf03Can>(settings, sink, scene);
}

Made make_serial_rangefinder(const RangefinderProfile& profile, ByteSink& sink, RangeScene& scene,
                             std::uint64_t seed) {
  switch (profile.unit) {
    case RangefinderModel::Lw20:
      return make_lwnx(LwnxModel::Lw20, profile, sink, scene, seed);
    case RangefinderModel::Sf30d:
      return make_lwnx(LwnxModel::Sf30d, profile, sink, scene, seed);
    case RangefinderModel::Sf45:
      return make_lwnx(LwnxModel::Sf45b, profile, sink, scene, seed);
    case RangefinderModel::Grf500:
      return make_lwnx(LwnxModel::Grf500, profile, sink, scene, seed);
    case RangefinderModel::Tf03:
    case RangefinderModel::Tf03Can:
      return std::make_unique<EmulatedTf03>(tf03_settings_of(profile, seed), sink, scene);
    case RangefinderModel::Lds70a:
      return make_point_laser(lds70a_settings(), profile, sink, scene, seed);
    case RangefinderModel::LaserAceIm:
      break;
  }
  return make_point_laser(laserace_im_settings(), profile, sink, scene, seed);
}

}  // namespace slamsensor::tools
