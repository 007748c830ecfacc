#pragma once

#include "firmware/config/layered_config.hpp"
#include "firmware/control/control_request.hpp"
#include "firmware/control/control_server.hpp"
#include "firmware/daemon/map_keeper.hpp"
#include "firmware/daemon/recording_keeper.hpp"
#include "firmware/daemon/sensor_threads.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "firmware/supervision/log.hpp"
#include "firmware/supervision/service.hpp"
#include "firmware/supervision/signals.hpp"

#include <tl/expected.hpp>

#include <memory>
#include <string>

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

/// Why the daemon cannot start.
struct StartFailure {
  ExitReason reason = ExitReason::Fault;
  std::string message;
};

/// The daemon: the threads of the sensor, and the supervisor that owns signals, watchdog, reloads, control
/// socket, map store and recordings (DESIGN 5). Everything here is on the main thread.
class Daemon {
 public:
  /// Takes all memory, opens devices and sockets, loads the map; nothing runs yet. `log` outlives it.
  [[nodiscard]] static tl::expected<std::unique_ptr<Daemon>, StartFailure> create(LayeredConfig config,
                                                                                  SourceMode source,
                                                                                  Log& log);

  /// Runs until a signal ends it.
  [[nodiscard]] tl::expected<void, StartFailure> run();

 private:
  Daemon(std::unique_ptr<LayeredConfig> config, Signals signals, std::unique_ptr<SensorThreads> threads,
         Log& log, hal::Stamp now);

  void turn(const OutputTime& now);
  void wait();
  void take_signals(const OutputTime& now);
  void reload(const OutputTime& now);
  void tell_manager(hal::Stamp now);
  void tell_facts(hal::Stamp now);
  [[nodiscard]] tl::expected<void, StartFailure> stop();

  std::unique_ptr<LayeredConfig> config_;  // the others look at what is in force in it
  Log& log_;
  Signals signals_;
  ServiceNotifier notifier_;
  std::unique_ptr<SensorThreads> threads_;
  MapKeeper maps_;
  RecordingKeeper recordings_;
  ControlContext control_;
  std::unique_ptr<ControlServer> server_;
  Watchdog watchdog_;
  bool is_ready_ = false;
  bool is_stopping_ = false;
  hal::Stamp told_{};
  hal::Stamp facts_told_{};
  hal::Stamp extended_{};
};

}  // namespace slamsensor::firmware
