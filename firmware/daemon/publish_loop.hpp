#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/daemon/handover.hpp"
#include "firmware/daemon/slam_loop.hpp"
#include "firmware/gpio/gpio_panel.hpp"
#include "firmware/lcm/lcm_publisher.hpp"
#include "firmware/lcm/lcm_sink.hpp"
#include "firmware/output/nmea_publisher.hpp"
#include "firmware/recording/recorder.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "firmware/serving/nmea_serial_sink.hpp"
#include "firmware/serving/nmea_tcp_server.hpp"
#include "firmware/status/sensor_status.hpp"
#include "firmware/status/sensor_tracker.hpp"
#include "firmware/status/status_text.hpp"
#include "firmware/supervision/file_descriptor.hpp"
#include "firmware/supervision/log.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>

namespace slamsensor::firmware {

/// What the supervisor gives the publish thread, for the status.
struct SupervisorFacts {
  hal::FixedText<64> map_name;
  std::optional<hal::Stamp> map_saved;  ///< when the map was last saved or loaded
  bool map_unsaved = false;
  bool realtime = false;
  std::uint32_t maps_replaced = 0;  ///< loads and resets since start: what was a fix before is none now
  CounterTable counters;            ///< of store and control
};

/// What publishing needs of the others; everything outlives the loop.
struct PublishInlets {
  SlamOutlets& slam;
  Mailbox<HeadStatus>& head;
  GpioOutputs* gpio = nullptr;  ///< null: no LED, no pulse
  Log& log;
};

/// Who this run of the daemon is.
struct RunIdentity {
  SourceMode source = SourceMode::Live;
  std::uint64_t initialization = 0;
  hal::Stamp start{};
};

/// Everything that goes out and may have to wait: NMEA, LCM, LED and pulse, recordings, the log of the
/// sensor's state. The body of the publish thread; what is said to be for any thread takes a lock.
class PublishLoop {
 public:
  /// The error names the setting.
  [[nodiscard]] static tl::expected<std::unique_ptr<PublishLoop>, std::string> create(
      const Config& config, const RunIdentity& identity, const PublishInlets& inlets);

  /// One turn.
  void step(const OutputTime& now);
  /// Waits until a step has something to do, at most 100 ms.
  void wait(const OutputTime& now);

  /// Any thread, also a real-time one: ends a wait. Never waits.
  void wake() noexcept;

  /// Any thread: the newest status.
  [[nodiscard]] SensorStatus status() const;
  /// Any thread: what can change live is changed with the next step.
  void set_config(const Config& config);
  void set_facts(const SupervisorFacts& facts);
  /// Any thread: from the next step on everything that goes out is recorded too.
  void begin_recording(std::shared_ptr<RecordingSession> session);
  /// Any thread: the recording is over; its file is closed when the last pointer to the session goes.
  void end_recording();

 private:
  PublishLoop(const Config& config, const RunIdentity& identity, const PublishInlets& inlets, LcmUrl url);

  [[nodiscard]] tl::expected<void, std::string> open_sinks(const Config& config);
  void take_changes();
  void take_statuses(hal::Stamp now);
  void answer(const FixMessage& message, const OutputTime& now);
  void report(const OutputTime& now);
  void refresh_status(hal::Stamp now);
  void publish_status(const OutputTime& now);
  void publish_map(const OutputTime& now);
  [[nodiscard]] bool begin_map(hal::Stamp now);
  void drive_gpio(hal::Stamp now);
  void log_changes(hal::Stamp now);
  void log_problem(std::string_view output, std::string_view problem, std::string& last);

  // What other threads hand over.
  struct Changes {
    std::optional<Config> config;
    std::optional<SupervisorFacts> facts;
    std::optional<std::shared_ptr<RecordingSession>> recording;
  };

  PublishInlets inlets_;
  RunIdentity identity_;
  DaemonConfig config_;
  SensorTracker tracker_;
  LcmSink lcm_sink_;
  std::optional<LcmPublisher> lcm_;
  NmeaPublisher nmea_;
  std::unique_ptr<NmeaSerialSink> serial_;
  std::unique_ptr<NmeaTcpServer> tcp_;
  FileDescriptor wake_;
  StatusLogger logger_;
  std::string lcm_problem_;
  std::string nmea_problem_;
  SupervisorFacts facts_;
  SensorStatus status_;  // of this thread
  std::shared_ptr<RecordingSession> recording_;
  // What LCM reported last, and whether with a pose, if only in a local map.
  std::optional<std::tuple<core::FixStatus, core::FixReason, bool>> told_{
      {core::FixStatus::NoFix, core::FixReason::NoScan, false}};
  hal::Stamp status_due_{};
  hal::Stamp map_due_{};
  hal::Stamp log_due_{};
  MapSnapshot map_;                         // being sent: its chunks belong to one state of the map
  std::optional<std::uint32_t> map_chunk_;  // next of it
  hal::Stamp map_repeat_{};
  hal::Stamp answer_last_{};
  hal::Stamp answer_max_{};

  mutable std::mutex mutex_;
  SensorStatus shared_status_;
  Changes changes_;
};

}  // namespace slamsensor::firmware
