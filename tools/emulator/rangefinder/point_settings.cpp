#include "tools/emulator/rangefinder/point_settings.hpp"

namespace slamsensor::tools {

PointSettings lds70a_settings() {
  PointSettings settings;
  settings.dialect = PointDialect::Lds70a;
  settings.format.prefix = "D";
  return settings;
}

PointSettings ldm41e_settings() {
  PointSettings settings;
  settings.dialect = PointDialect::Ldm41e;
  settings.format.digits = 3;
  settings.format.quality_digits = 6;
  settings.format.no_return = "E15";
  settings.format.error = "E24";
  settings.baud = 9600;
  settings.factory_baud = 9600;
  settings.rate_hz = 10.0;
  settings.identity = "LDM41E 1.6 EMU-000001";
  settings.quality = {2e4, 1024.0};
  settings.quality_of_blinded = 1024.0;
  return settings;
}

PointSettings laserace_im_settings() {
  PointSettings settings;
  settings.format.digits = 3;
  settings.format.decimals = 1;
  settings.format.no_return = "000.0";
  settings.format.error = "E01";
  settings.identity = "LaserAce IM HR (unverified)";
  return settings;
}

}  // namespace slamsensor::tools
