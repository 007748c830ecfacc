#include "tools/emulator/ptu/ptu_config.hpp"

namespace slamsensor::tools {

PtuConfig factory_config(const PtuSettings& settings) {
  PtuConfig config;
  for (const PtuAxisId axis : {PtuAxisId::Pan, PtuAxisId::Tilt}) {
    const PtuAxisModel& model = model_of(settings, axis);
    PtuAxisConfig& own = config.axes[index_of(axis)];
    own.speed = model.speed;
    own.acceleration = model.acceleration;
    own.base_speed = model.base_speed;
    own.lower_speed = model.lower_speed;
    own.upper_speed = model.upper_speed;
  }
  config.start_baud = settings.factory_baud;
  return config;
}

}  // namespace slamsensor::tools
