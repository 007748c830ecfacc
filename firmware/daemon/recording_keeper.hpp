#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/daemon/map_keeper.hpp"
#include "firmware/daemon/sensor_threads.hpp"
#include "firmware/recording/recorder.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "firmware/supervision/log.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// The supervisor's hand on recordings. One begins with the devices' drivers starting over and with the map
/// of that moment, so that its replay goes the same way, bit for bit. One thread, which waits for the disk
/// but for no other thread.
class RecordingKeeper {
 public:
  /// All outlive this.
  RecordingKeeper(const Config& config, SensorThreads& threads, MapKeeper& maps, Log& log);

  /// One turn; an answer to a request when it is ready.
  [[nodiscard]] std::optional<MapKeeper::Answer> step(const OutputTime& now);
  /// Ends a recording, when all threads have stopped.
  void finish_at_end(const OutputTime& now);

  // Requests of the control socket. An empty name: one made of the time.
  [[nodiscard]] ControlOutcome start(ControlToken token, std::string_view name, const OutputTime& now);
  [[nodiscard]] ControlOutcome stop(ControlToken token);
  [[nodiscard]] ControlResult status() const;

  /// The head could not be made again after a recording had begun or ended: the daemon must end.
  [[nodiscard]] const std::optional<std::string>& failure() const { return failure_; }

 private:
  enum class Phase : std::uint8_t {
    Idle,
    Draining,  ///< no scan is made; the SLAM thread finishes what it has
    Settling,  ///< it drops the rivals of its best hypothesis
    Recording,
    Ending,  ///< the publish thread lets go of the session
  };

  [[nodiscard]] std::optional<MapKeeper::Answer> answer(ControlResult result);
  [[nodiscard]] std::optional<MapKeeper::Answer> settle(const OutputTime& now);
  [[nodiscard]] ControlResult begin(const OutputTime& now);
  void leave();
  void on_map_order(MapCommand kind, const SlamAnswer& answer);

  const Config& config_;
  SensorThreads& threads_;
  MapKeeper& maps_;
  Log& log_;
  Phase phase_ = Phase::Idle;
  ControlToken token_ = 0;
  std::string name_;
  std::uint32_t scans_before_ = 0;
  std::shared_ptr<RecordingSession> session_;
  std::optional<std::string> failure_;
};

}  // namespace slamsensor::firmware
