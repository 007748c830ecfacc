#include "tools/emulator/rangefinder/tf03_settings.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {

Tf03Settings tf03_settings(BenewakeModel model) {
  Tf03Settings settings;
  settings.model = model;
  switch (model) {
    case BenewakeModel::Tf03:
      break;
    case BenewakeModel::TfMini:
      settings.no_return_cm = 65'535;
      settings.strength_min = 20.0;
      settings.strength_of_weak = 10;
      break;
    case BenewakeModel::TfMiniPlus:
      settings.no_return_cm = 0;
      settings.strength_min = 100.0;
      settings.strength_of_weak = 60;
      settings.strength_of_blinded = 65'535;
      break;
    case BenewakeModel::TfMiniS:
      settings.no_return_cm = 65'535;  // -1: too faint
      settings.strength_min = 100.0;
      settings.strength_of_weak = 60;
      settings.strength_of_blinded = 65'535;
      break;
    case BenewakeModel::Tf02:
      settings.no_return_cm = 2'200;
      break;
  }
  return settings;
}

std::uint32_t nearest_tf03_rate(double rate_hz) {
  const double limited = std::clamp(rate_hz, 1.0, 10'000.0);
  const double decade = std::pow(10.0, std::min(3.0, std::floor(std::log10(limited))));
  return static_cast<std::uint32_t>(std::llround(std::round(limited / decade) * decade));
}

void set_rate(Tf03Settings& settings, double rate_hz) {
  settings.saved.rate_hz = nearest_tf03_rate(rate_hz);
}

}  // namespace slamsensor::tools
