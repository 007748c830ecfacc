#pragma once

#include "firmware/config/layered_config.hpp"
#include "firmware/control/control_request.hpp"
#include "firmware/daemon/map_keeper.hpp"
#include "firmware/daemon/recording_keeper.hpp"
#include "firmware/daemon/sensor_threads.hpp"
#include "firmware/supervision/log.hpp"

namespace slamsensor::firmware {

/// What the verbs of the control socket act on. All of it outlives the context; on the main thread.
struct ControlContext {
  LayeredConfig& config;
  SensorThreads& threads;
  MapKeeper& maps;
  RecordingKeeper& recordings;
  Log& log;
  ScanMode mode = config.current().config.scan_head.scan.mode;  ///< of the settings; another may be in force
};

/// Brings the settings in force to all stations; the datum of the map is in force where none is configured.
void apply_config(ControlContext& context);

/// Reads the files of the configuration again, and applies them. The reply lists what has changed.
[[nodiscard]] ControlResult reload_config(ControlContext& context);

}  // namespace slamsensor::firmware
