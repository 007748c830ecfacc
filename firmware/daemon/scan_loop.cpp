#include "firmware/daemon/scan_loop.hpp"

#include "firmware/recording/recording_links.hpp"

#include <array>
#include <variant>

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kReportPeriod = std::chrono::milliseconds(100);
constexpr hal::Stamp kStop = std::chrono::seconds(1);
constexpr hal::Stamp kRatePeriod = std::chrono::seconds(1);

std::string_view phase_of(const ScanScheduler& scheduler) noexcept {
  if (scheduler.state() == SchedulerState::Waiting) {
    return "waiting";
  }
  return scheduler.pass() == ScanPass::Scan ? "scanning" : "calibrating";
}

template <typename DeviceInfoText>
hal::FixedText<80> text80(const DeviceInfoText& text) noexcept {
  return hal::FixedText<80>(text.view());
}

}  // namespace

tl::expected<std::unique_ptr<HeadRuntime>, std::string> HeadRuntime::create(const Config& config,
                                                                            TapeWriter* tape) {
  auto links = open_head_links(config.head);
  if (!links) {
    return tl::unexpected(links.error().message);
  }
  std::unique_ptr<HeadRuntime> runtime(new HeadRuntime(std::move(*links)));
  if (tape != nullptr) {
    runtime->tape_ = tape;
    runtime->taps_.emplace(runtime->links_.get()).attach(tape);
  }
  auto drivers =
      make_head_drivers(config.head, tape != nullptr ? runtime->taps_->get() : runtime->links_.get());
  if (!drivers) {
    return tl::unexpected(drivers.error().message);
  }
  runtime->drivers_ = std::move(*drivers);
  runtime->head_ = std::make_unique<SensorHead>(*runtime->drivers_.pan_tilt, *runtime->drivers_.rangefinder,
                                                config.scan_head);
  return runtime;
}

void HeadRuntime::leave_tape() noexcept {
  if (taps_) {
    taps_->attach(nullptr);  // the drivers stay on them, and the devices at work
  }
  tape_ = nullptr;
}

ScanLoop::ScanLoop(HeadRuntime& head, GpioInputs* panel, ScanOrders& orders, ScanQueue& queue, Wakeup& slam,
                   Mailbox<HeadStatus>& status)
    : head_(head),
      panel_(panel),
      orders_(orders),
      queue_(queue),
      slam_(slam),
      status_(status),
      scans_requested_(orders.scans_requested),
      aborts_requested_(orders.aborts_requested) {
}

void ScanLoop::step(hal::Stamp now, const PeriodicTimer& timer) noexcept {
  if (stepped_ > hal::Stamp{} && now - stepped_ >= kStop) {
    ++stops_;
    last_stop_ = now - stepped_;
  }
  stepped_ = now;
  obey(now);
  if (TapeWriter* const tape = head_.tape()) {
    tape->step(now);
  }
  head_.head().step(now);
  hand_on();
  pan_tilt_watch_.step(head_.pan_tilt().state(), head_.pan_tilt().problem(), now);
  rangefinder_watch_.step(head_.rangefinder().state(), head_.rangefinder().problem(), now);
  if (now - reported_ >= kReportPeriod) {
    reported_ = now;
    report(now, timer);
  }
}

void ScanLoop::obey(hal::Stamp now) noexcept {
  if (const ScanMode mode = orders_.mode.load(std::memory_order_relaxed); mode != mode_) {
    mode_ = mode;
    command(TapeCommand::SetMode, static_cast<std::uint64_t>(mode));
  }
  if (const std::uint32_t requested = orders_.scans_requested; requested != scans_requested_) {
    scans_requested_ = requested;
    command(TapeCommand::RequestScan);
  }
  if (const std::uint32_t requested = orders_.aborts_requested; requested != aborts_requested_) {
    aborts_requested_ = requested;
    command(TapeCommand::AbortScan);
  }
  set_hold(HoldReason::Paused, orders_.paused.load(std::memory_order_relaxed));
  if (panel_ != nullptr) {
    const GpioOrders panel = panel_->poll(now);
    if (panel.scan_wanted) {
      command(TapeCommand::RequestScan);
    }
    set_hold(HoldReason::InterlockOpen, panel.interlock_open);
  }
  if (inclination_) {
    if (const auto order = inclination_->step(now)) {
      command(order->what, order->argument);
    }
  }
}

void ScanLoop::set_hold(HoldReason reason, bool is_held) noexcept {
  bool& held = is_held_[static_cast<std::size_t>(reason)];
  if (held != is_held) {
    held = is_held;
    command(is_held ? TapeCommand::Hold : TapeCommand::Release, static_cast<std::uint64_t>(reason));
  }
}

void ScanLoop::command(TapeCommand what, std::uint64_t argument) noexcept {
  if (TapeWriter* const tape = head_.tape()) {
    tape->command(what, argument);
  }
  firmware::command(head_.head(), what, argument);
}

void ScanLoop::hand_on() noexcept {
  bool has_news = false;
  while (const auto event = head_.head().take()) {
    if (const auto* begun = std::get_if<ScanBegun>(&*event)) {
      scan_ = begun->scan;
    }
    queue_.push(*event);
    has_news = true;
  }
  if (has_news) {
    slam_.notify();
  }
}

void ScanLoop::report(hal::Stamp now, const PeriodicTimer& timer) noexcept {
  measure_rate(now);
  HeadStatus& status = status_.draft();
  const SensorHead& head = head_.head();
  status.stamp = now;
  pan_tilt_watch_.report(head_.pan_tilt(), status.pan_tilt);
  status.pan_tilt.counters.append(head_.pan_tilt_link());
  status.pan_tilt.model = text80(head_.pan_tilt().info().model);
  rangefinder_watch_.report(head_.rangefinder(), status.rangefinder);
  status.rangefinder.counters.append(head_.rangefinder_link());
  status.rangefinder.model = text80(head_.rangefinder().info().product);
  status.phase = phase_of(head.scheduler());
  status.problem = ProblemText(head.problem());
  if (inclination_) {
    status.inclinometer = inclination_->device();
    if (head.scheduler().held() == HoldReason::LeanUnknown &&
        !inclination_->device().problem.view().empty()) {
      status.problem = inclination_->device().problem;
    }
  }
  status.attitude = head.attitude();
  status.timing_in_doubt = head.is_timing_in_doubt();
  status.failing = head.is_failing();
  status.held = head.scheduler().held().has_value();
  status.scan = scan_;
  status.line = head.scheduler().line();
  status.lines = head.scheduler().plan().lines;
  status.pan_rad = head_.pan_tilt().axis(hal::Axis::Pan).position_rad;
  status.tilt_rad = head_.pan_tilt().axis(hal::Axis::Tilt).position_rad;
  status.latency_s = head.latency().latency_s;
  status.latency_sigma_s = head.latency().sigma_s;
  status.readings = head.readings();
  status.readings_hz = rate_hz_;
  status.stops = stops_;
  status.last_stop = last_stop_;
  status.wake_latency_max = timer.wake_latency_max();
  status.counters.size = 0;
  status.counters.append(timer.counters());
  status.counters.append(head.scheduler().counters());
  status.counters.append(core::kAssemblerEventNames, head.assembler().counts());
  status.counters.append(head.counters());
  const std::array<hal::Counter, 3> queue = {{{"scanlines_dropped", queue_.scanlines_dropped()},
                                              {"scan_messages_dropped", queue_.messages_dropped()},
                                              {"head_events_dropped", head.events_dropped()}}};
  status.counters.append(queue);
  if (panel_ != nullptr) {
    status.counters.append(panel_->counters());
  }
  status_.post();
}

void ScanLoop::measure_rate(hal::Stamp now) noexcept {
  if (now - rate_since_ < kRatePeriod) {
    return;
  }
  const std::uint64_t readings = head_.head().readings();
  rate_hz_ = static_cast<double>(readings - rate_readings_) / hal::to_seconds(now - rate_since_);
  rate_readings_ = readings;
  rate_since_ = now;
}

}  // namespace slamsensor::firmware
