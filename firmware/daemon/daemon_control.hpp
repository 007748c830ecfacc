#pragma once

#include "firmware/config/layered_config.hpp"
#include "firmware/control/control_target.hpp"
#include "firmware/daemon/map_keeper.hpp"
#include "firmware/daemon/recording_keeper.hpp"
#include "firmware/daemon/sensor_threads.hpp"
#include "firmware/supervision/log.hpp"

#include <string>

namespace slamsensor::firmware {

/// What requests of the control socket do to the daemon. On the main thread.
class DaemonControl final : public ControlTarget {
 public:
  /// All outlive this.
  DaemonControl(LayeredConfig& config, SensorThreads& threads, MapKeeper& maps, RecordingKeeper& recordings,
                Log& log)
      : config_(config),
        threads_(threads),
        maps_(maps),
        recordings_(recordings),
        log_(log),
        mode_(config.current().config.scan_head.scan.mode) {}

  /// Brings what is in force to all stations.
  void apply();

  [[nodiscard]] const SensorStatus& status() override;
  [[nodiscard]] std::string version() const override;

  ControlOutcome scan_now(ControlToken token) override;
  ControlOutcome scan_pause(ControlToken token) override;
  ControlOutcome scan_resume(ControlToken token) override;
  ControlOutcome scan_mode(ControlToken token, ScanMode mode) override;

  ControlOutcome map_list(ControlToken token) override;
  ControlOutcome map_info(ControlToken token) override;
  ControlOutcome map_save(ControlToken token, std::string_view name) override;
  ControlOutcome map_load(ControlToken token, std::string_view name) override;
  ControlOutcome map_remove(ControlToken token, std::string_view name) override;
  ControlOutcome map_reset(ControlToken token) override;
  ControlOutcome map_mode(ControlToken token, MapMode mode) override;

  ControlOutcome datum_show(ControlToken token) override;
  ControlOutcome datum_set(ControlToken token, const Datum& datum) override;
  ControlOutcome datum_clear(ControlToken token) override;

  ControlOutcome config_get(ControlToken token, std::string_view key) override;
  ControlOutcome config_set(ControlToken token, std::string_view key, std::string_view value) override;
  ControlOutcome config_unset(ControlToken token, std::string_view key) override;
  ControlOutcome config_list(ControlToken token) override;
  ControlOutcome config_reload(ControlToken token) override;

  ControlOutcome record_start(ControlToken token, std::string_view name) override;
  ControlOutcome record_stop(ControlToken token) override;
  ControlOutcome record_status(ControlToken token) override;

  ControlOutcome set_log_level(ControlToken token, LogLevel level) override;

 private:
  /// The settings in force; where no datum is configured, that of the map.
  [[nodiscard]] Config effective() const;
  [[nodiscard]] ControlResult reconfigured(const LayeredConfig::Result& result, std::string_view what);

  LayeredConfig& config_;
  SensorThreads& threads_;
  MapKeeper& maps_;
  RecordingKeeper& recordings_;
  Log& log_;
  SensorStatus status_;
  ScanMode mode_;  // of the settings; another may have been asked for since
};

}  // namespace slamsensor::firmware
