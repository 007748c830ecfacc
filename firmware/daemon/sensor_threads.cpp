#include "firmware/daemon/sensor_threads.hpp"

#include "hal/clock.hpp"

#include <utility>

namespace slamsensor::firmware {
namespace {

// Of SCHED_FIFO. Bytes come before poses, and both before the kernel's interrupt threads (50).
constexpr std::uint32_t kScanPriority = 80;
constexpr std::uint32_t kSlamPriority = 60;

constexpr hal::Stamp kSlamNap = std::chrono::milliseconds(50);
constexpr hal::Stamp kScanSilence = std::chrono::seconds(5);
constexpr hal::Stamp kSlamSilence = std::chrono::seconds(10);     // beside its deadline
constexpr hal::Stamp kPublishSilence = std::chrono::seconds(60);  // a slow disk is no reason to die
constexpr hal::Stamp kInclinationSilence = std::chrono::seconds(60);
constexpr hal::Stamp kInclinationAgeMax = std::chrono::seconds(3);  // an older one stops the scanning
constexpr hal::Stamp kInclinationNap = std::chrono::milliseconds(5);

hal::Stamp clock_now(void*) noexcept {
  return hal::monotonic_now();
}

OutputTime output_now() {
  const hal::Stamp now = hal::monotonic_now();
  return {now, now + hal::realtime_ahead()};
}

std::size_t beat_of(Heartbeats& heartbeats, std::string_view name, hal::Stamp silence) {
  return heartbeats.add({name, silence}).value_or(Heartbeats::kThreadsMax);
}

}  // namespace

tl::expected<std::unique_ptr<SensorThreads>, std::string> SensorThreads::create(const Config& config,
                                                                                const RunIdentity& identity,
                                                                                Log& log) {
  std::unique_ptr<SensorThreads> threads(new SensorThreads(config, log));
  if (auto opened = threads->open(identity); !opened) {
    return tl::unexpected(opened.error());
  }
  return threads;
}

SensorThreads::SensorThreads(const Config& config, Log& log)
    : config_(config),
      log_(log),
      scan_beat_(beat_of(heartbeats_, "scan", kScanSilence)),
      slam_beat_(beat_of(heartbeats_, "slam",
                         kSlamSilence + hal::from_seconds(config.daemon.realtime.slam_deadline_s))),
      publish_beat_(beat_of(heartbeats_, "publish", kPublishSilence)),
      scan_queue_(config.daemon.realtime.scanlines_queued, config.scan_head.scan.readings_per_line_max),
      slam_outlets_(config.core.capacities),
      slam_(config, scan_queue_, slam_orders_, slam_outlets_),
      timer_(hal::from_seconds(config.daemon.realtime.scan_period_s),
             hal::from_seconds(config.daemon.realtime.scan_deadline_s)) {
  scan_orders_.mode = config.scan_head.scan.mode;
}

tl::expected<void, std::string> SensorThreads::open(const RunIdentity& identity) {
  auto panel = GpioPanel::open(config_.daemon.gpio);
  if (!panel) {
    return tl::unexpected(panel.error().message);
  }
  gpio_ = std::move(*panel);
  auto inclination = InclinationLoop::create(config_);
  if (!inclination) {
    return tl::unexpected(inclination.error());
  }
  inclination_ = std::move(*inclination);
  if (inclination_) {
    inclination_beat_ = beat_of(heartbeats_, "inclination", kInclinationSilence);
  }
  auto head = HeadRuntime::create(config_, nullptr);
  if (!head) {
    return tl::unexpected(head.error());
  }
  head_ = std::move(*head);
  auto publish = PublishLoop::create(
      config_, identity, {slam_outlets_, head_status_, gpio_ ? &gpio_->outputs() : nullptr, log_});
  if (!publish) {
    return tl::unexpected(publish.error());
  }
  publish_ = std::move(*publish);
  return {};
}

tl::expected<void, std::string> SensorThreads::start() {
  const RealtimeMode mode = config_.daemon.realtime.mode;
  is_realtime_ = mode != RealtimeMode::Off;
  if (mode != RealtimeMode::Off) {
    if (auto locked = lock_memory(); !locked) {
      if (mode == RealtimeMode::Required) {
        return locked;
      }
      is_realtime_ = false;
      log_.warning(locked.error());
    }
  }
  auto publish = start_thread({"publish"}, [this] { run_publish(); });
  if (!publish) {
    return tl::unexpected(publish.error());
  }
  publish_thread_ = std::move(*publish);
  auto slam = start_thread({"slam", kSlamPriority}, [this] { run_slam(); });
  if (!slam) {
    return tl::unexpected(slam.error());
  }
  slam_thread_ = std::move(*slam);
  if (inclination_) {
    auto inclination = start_thread({"inclination"}, [this] { run_inclination(); });
    if (!inclination) {
      return tl::unexpected(inclination.error());
    }
    inclination_thread_ = std::move(*inclination);
  }
  return start_scanning();
}

/// Without the right to its priority a thread runs at the ordinary one, if the setting allows that.
tl::expected<Thread, std::string> SensorThreads::start_thread(ThreadConfig config,
                                                              std::function<void()> body) {
  const RealtimeMode mode = config_.daemon.realtime.mode;
  if (mode == RealtimeMode::Off) {
    config.fifo_priority = 0;
  }
  auto thread = Thread::start(config, body);
  if (!thread && mode == RealtimeMode::Optional && config.fifo_priority > 0) {
    log_.warning(thread.error());
    is_realtime_ = false;
    config.fifo_priority = 0;
    thread = Thread::start(config, std::move(body));
  }
  return thread;
}

tl::expected<void, std::string> SensorThreads::start_scanning() {
  scan_ = std::make_unique<ScanLoop>(*head_, gpio_ ? &gpio_->inputs() : nullptr, scan_orders_, scan_queue_,
                                     slam_wakeup_, head_status_);
  if (inclination_) {
    scan_->read_inclination(inclination_->reports(), kInclinationAgeMax);
  }
  return resume_scanning();
}

tl::expected<void, std::string> SensorThreads::resume_scanning() {
  stop_scan_ = false;
  timer_.restart();
  auto thread = start_thread({"scan", kScanPriority}, [this] { run_scan(); });
  if (!thread) {
    return tl::unexpected(thread.error());
  }
  scan_thread_ = std::move(*thread);
  return {};
}

void SensorThreads::stop_scanning() {
  stop_scan_ = true;
  scan_thread_.join();
}

tl::expected<void, std::string> SensorThreads::restart_head(TapeWriter* tape) {
  stop_scanning();
  // The old head closes its ports before the new one opens them.
  scan_.reset();
  head_.reset();
  auto head = HeadRuntime::create(config_, tape);
  if (!head) {
    return tl::unexpected(head.error());
  }
  head_ = std::move(*head);
  return start_scanning();
}

tl::expected<void, std::string> SensorThreads::leave_tape() {
  stop_scanning();
  head_->leave_tape();
  return resume_scanning();
}

void SensorThreads::stop() {
  stop_scanning();
  stop_inclination_ = true;
  inclination_thread_.join();
  stop_slam_ = true;
  slam_wakeup_.notify();
  slam_thread_.join();
  stop_publish_ = true;
  if (publish_) {
    publish_->wake();
  }
  publish_thread_.join();
}

bool SensorThreads::is_slam_idle() const noexcept {
  return scan_queue_.is_empty() && !slam_busy_;
}

void SensorThreads::run_scan() {
  while (!stop_scan_.load(std::memory_order_relaxed)) {
    const hal::Stamp now = timer_.wait();
    scan_->step(now, timer_);
    heartbeats_.beat(scan_beat_);
    timer_.end_step(hal::monotonic_now());
  }
}

void SensorThreads::run_slam() {
  while (!stop_slam_.load(std::memory_order_relaxed)) {
    slam_wakeup_.wait(hal::monotonic_now() + kSlamNap);
    slam_busy_ = true;
    bool has_news = false;
    while (!stop_slam_.load(std::memory_order_relaxed) &&
           slam_.step({clock_now, hal::realtime_ahead(), &stop_slam_})) {
      heartbeats_.beat(slam_beat_);
      has_news = true;
    }
    slam_busy_ = false;
    heartbeats_.beat(slam_beat_);
    if (has_news) {
      publish_->wake();
    }
  }
  slam_.end();
}

void SensorThreads::run_inclination() {
  Wakeup nap;
  while (!stop_inclination_.load(std::memory_order_relaxed)) {
    const hal::Stamp now = hal::monotonic_now();
    inclination_->step(now);
    heartbeats_.beat(inclination_beat_);
    nap.wait(now + kInclinationNap);
  }
}

void SensorThreads::run_publish() {
  while (!stop_publish_.load(std::memory_order_relaxed)) {
    publish_->step(output_now());
    heartbeats_.beat(publish_beat_);
    publish_->wait(output_now());
  }
  publish_->step(output_now());
}

}  // namespace slamsensor::firmware
