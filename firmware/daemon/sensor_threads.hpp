#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/daemon/handover.hpp"
#include "firmware/daemon/inclination_loop.hpp"
#include "firmware/daemon/publish_loop.hpp"
#include "firmware/daemon/realtime.hpp"
#include "firmware/daemon/scan_loop.hpp"
#include "firmware/daemon/slam_loop.hpp"
#include "firmware/gpio/gpio_panel.hpp"
#include "firmware/supervision/log.hpp"
#include "firmware/supervision/service.hpp"

#include <tl/expected.hpp>

#include <atomic>
#include <memory>
#include <string>

namespace slamsensor::firmware {

/// The three threads of DESIGN 5 and what lies between them: scan (bytes to scanlines), SLAM (scanlines to
/// fixes), publish (everything that may wait); a fourth one reads the inclinometer if there is one. Made,
/// started and stopped by the supervisor, on its thread.
class SensorThreads {
 public:
  /// Takes all memory and opens the devices; nothing runs yet. `config` outlives it, and may change between
  /// two calls in what can change live. The error names the setting.
  [[nodiscard]] static tl::expected<std::unique_ptr<SensorThreads>, std::string> create(
      const Config& config, const RunIdentity& identity, Log& log);
  SensorThreads(const SensorThreads&) = delete;
  SensorThreads& operator=(const SensorThreads&) = delete;
  ~SensorThreads() { stop(); }

  /// All threads run, in real time as far as realtime.mode asks for it and the system grants it. The error
  /// says which right is missing.
  [[nodiscard]] tl::expected<void, std::string> start();
  /// All threads have ended: first scan, then the inclinometer's, then SLAM, then publish.
  void stop();

  /// No scan goes on until restart_head().
  void stop_scanning();
  /// Stops the scan thread, and makes the head anew when it goes on: drivers start over, on `tape` when it is
  /// not null. After an error there is no head any more.
  [[nodiscard]] tl::expected<void, std::string> restart_head(TapeWriter* tape);
  /// The scan thread writes onto no tape any more, and goes on.
  [[nodiscard]] tl::expected<void, std::string> leave_tape();

  /// Whether the SLAM thread has taken everything that the scan thread made.
  [[nodiscard]] bool is_slam_idle() const noexcept;

  [[nodiscard]] bool is_realtime() const noexcept { return is_realtime_; }
  [[nodiscard]] ScanOrders& scan_orders() noexcept { return scan_orders_; }
  [[nodiscard]] SlamOrders& slam_orders() noexcept { return slam_orders_; }
  /// The home map as the SLAM thread has it.
  [[nodiscard]] MapOutlet& map() noexcept { return slam_outlets_.map; }
  /// An order was given.
  void wake_slam() noexcept { slam_wakeup_.notify(); }
  [[nodiscard]] PublishLoop& publish() noexcept { return *publish_; }
  [[nodiscard]] Heartbeats& heartbeats() noexcept { return heartbeats_; }

 private:
  SensorThreads(const Config& config, Log& log);

  [[nodiscard]] tl::expected<void, std::string> open(const RunIdentity& identity);
  [[nodiscard]] tl::expected<void, std::string> start_scanning();
  [[nodiscard]] tl::expected<void, std::string> resume_scanning();
  [[nodiscard]] tl::expected<Thread, std::string> start_thread(ThreadConfig config,
                                                               std::function<void()> body);
  void run_scan();
  void run_slam();
  void run_publish();
  void run_inclination();

  const Config& config_;  // of the main thread
  Log& log_;
  Heartbeats heartbeats_;
  std::size_t scan_beat_;
  std::size_t slam_beat_;
  std::size_t publish_beat_;
  ScanQueue scan_queue_;
  Wakeup slam_wakeup_;
  ScanOrders scan_orders_;
  SlamOrders slam_orders_;
  SlamOutlets slam_outlets_;
  Mailbox<HeadStatus> head_status_;
  SlamLoop slam_;
  PeriodicTimer timer_;
  std::unique_ptr<GpioPanel> gpio_;
  std::unique_ptr<InclinationLoop> inclination_;  // null: there is no inclinometer
  std::size_t inclination_beat_ = Heartbeats::kThreadsMax;
  std::unique_ptr<HeadRuntime> head_;
  std::unique_ptr<ScanLoop> scan_;
  std::unique_ptr<PublishLoop> publish_;
  std::atomic<bool> stop_scan_{false};
  std::atomic<bool> stop_slam_{false};
  std::atomic<bool> stop_publish_{false};
  std::atomic<bool> stop_inclination_{false};
  std::atomic<bool> slam_busy_{false};
  bool is_realtime_ = false;
  Thread publish_thread_;
  Thread slam_thread_;
  Thread inclination_thread_;
  Thread scan_thread_;
};

}  // namespace slamsensor::firmware
