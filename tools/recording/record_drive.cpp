#include "tools/recording/record_drive.hpp"

#include "core/detection/levelling.hpp"
#include "firmware/pipeline.hpp"
#include "firmware/recording/config_toml.hpp"
#include "firmware/recording/head_command.hpp"
#include "firmware/recording/recorder.hpp"
#include "firmware/recording/recording_links.hpp"
#include "firmware/scan/sensor_head.hpp"
#include "tools/drive/head_drivers.hpp"
#include "tools/emulator/head_truth.hpp"
#include "tools/recording/fix_messages.hpp"

#include <limits>
#include <utility>
#include <variant>

namespace slamsensor::tools {
namespace {

constexpr Stamp kStep = std::chrono::milliseconds(1);
constexpr Stamp kPatience = std::chrono::hours(1);
constexpr Stamp kInclinationPeriod = std::chrono::milliseconds(100);

constexpr std::int64_t to_us(Stamp time) noexcept {
  return std::chrono::duration_cast<std::chrono::microseconds>(time).count();
}

std::uint32_t scans_wanted(const RecordDrive& order) {
  return order.scans.value_or(order.seconds ? std::numeric_limits<std::uint32_t>::max() : 1);
}

firmware::HeadConfig head_of(const Scenario& scenario, const firmware::HeadConfig& base) {
  firmware::HeadConfig head = head_config(scenario.head);
  head.pan_tilt_port = base.pan_tilt_port;
  head.rangefinder_port = base.rangefinder_port;
  head.can_interface = base.can_interface;
  return head;
}

/// What an inclinometer with this offset tells of itself on a sensor that leans like the mount.
core::Attitude told_inclination(const SweepConfig& mount, const core::Attitude& offset) {
  return core::attitude_of_up(core::level_from_sensor(offset).transpose() *
                              core::up_L({mount.roll_rad, mount.pitch_rad}));
}

/// Puts chunks into the recording as they come.
class RecorderSink final : public firmware::TapeSink {
 public:
  RecorderSink(firmware::Recorder& recorder, const SimClock& clock) : recorder_(recorder), clock_(clock) {}

  bool take(const firmware::TapeChunk& chunk) noexcept override {
    recorder_.tape(to_us(clock_.now), chunk);
    ++chunks_;
    return true;
  }
  [[nodiscard]] std::uint64_t chunks() const noexcept { return chunks_; }

 private:
  firmware::Recorder& recorder_;
  const SimClock& clock_;
  std::uint64_t chunks_ = 0;
};

/// A sensor under way: emulated head, taps, drivers, pipeline, recording.
class Drive {
 public:
  Drive(std::unique_ptr<InProcessHead> head, const SweepConfig& mount, firmware::Recorder& recorder,
        const firmware::Config& config)
      : head_(std::move(head)),
        recorder_(recorder),
        config_(config),
        inclination_(told_inclination(mount, config.scan_head.levelling.offset)),
        sink_(recorder, head_->head().clock()),
        tape_(sink_),
        links_({head_->ptu_bytes(), head_->ptu_can(), head_->rangefinder_bytes(), head_->rangefinder_can()}),
        pipeline_(config.core) {}

  [[nodiscard]] tl::expected<void, WorldError> start() {
    auto messages = FixMessages::create(config_, recorder_);
    if (!messages) {
      return tl::unexpected(messages.error());
    }
    messages_ = std::move(*messages);
    links_.attach(&tape_);
    auto drivers = firmware::make_head_drivers(config_.head, links_.get());
    if (!drivers) {
      return tl::unexpected(WorldError{drivers.error().message});
    }
    drivers_ = std::move(*drivers);
    sensor_ =
        std::make_unique<firmware::SensorHead>(*drivers_.pan_tilt, *drivers_.rangefinder, config_.scan_head);
    return {};
  }

  void run(const RecordDrive& order, const RecordProgress& progress) {
    const Stamp end = order.seconds ? hal::from_seconds(*order.seconds) : hal::kNever;
    const std::uint32_t scans = scans_wanted(order);
    Stamp last_scan{};
    while (summary_.scans < scans && head_->now() < end && head_->now() < last_scan + kPatience) {
      if (!step()) {
        continue;
      }
      last_scan = head_->now();
      if (!order.seconds) {
        static_cast<void>(head_->head().next_stand());
      }
      if (progress) {
        tell(progress, order, scans);
      }
    }
  }

  RecordSummary finish() {
    static_cast<void>(tape_.finish());  // its sink always has room
    summary_.tape_chunks = sink_.chunks();
    summary_.simulated_s = hal::to_seconds(head_->now());
    summary_.problem = sensor_->problem();
    summary_.faults = format_events(head_->head(), Stamp{});
    return std::move(summary_);
  }

 private:
  void tell(const RecordProgress& progress, const RecordDrive& order, std::uint32_t scans) const {
    if (order.scans || !order.seconds) {
      progress(summary_.scans, scans);
    } else {
      progress(static_cast<std::uint32_t>(hal::to_seconds(head_->now())),
               static_cast<std::uint32_t>(*order.seconds));
    }
  }

  /// The inclinometer's measurements, as the daemon gets them from its own thread.
  void incline() {
    if (!config_.scan_head.levelling.has_inclinometer() || head_->now() < inclination_due_) {
      return;
    }
    inclination_due_ = head_->now() + kInclinationPeriod;
    const std::uint64_t argument = firmware::pack_inclination(inclination_.roll_rad, inclination_.pitch_rad);
    tape_.command(firmware::TapeCommand::Incline, argument);
    firmware::command(*sensor_, firmware::TapeCommand::Incline, argument);
  }

  /// One millisecond; true when a scan ended in it.
  bool step() {
    head_->advance(head_->now() + kStep);
    incline();
    tape_.step(head_->now());
    sensor_->step(head_->now());
    bool has_ended = false;
    while (const auto event = sensor_->take()) {
      if (const auto* line = std::get_if<firmware::Scanline>(&*event)) {
        pipeline_.slam().add_scanline(line->readings);
        readings_ += line->readings.size();
      } else if (const auto* ended = std::get_if<firmware::ScanEnded>(&*event)) {
        localise(*ended);
        has_ended = true;
      } else {
        summary_.scans_aborted += std::holds_alternative<firmware::ScanAborted>(*event) ? 1 : 0;
        pipeline_.slam().drop_scan();
        readings_ = 0;
      }
    }
    return has_ended;
  }

  void localise(const firmware::ScanEnded& scan) {
    const core::ScanTime time{scan.begin, scan.middle, scan.end, scan.end};
    const core::Fix fix = pipeline_.slam().finish_scan(time, core::Deadline{});
    messages_->write(fix, pipeline_.slam().scan_landmarks(), head_->now());
    ++summary_.scans;
    summary_.fixes += fix.status == core::FixStatus::Fix ? 1 : 0;
    summary_.readings += std::exchange(readings_, 0);
    summary_.truth.push_back(
        {static_cast<double>(time.middle_utc.count()) / 1e9, head_->head().visits().back().visit.pose_W});
  }

  std::unique_ptr<InProcessHead> head_;
  firmware::Recorder& recorder_;
  const firmware::Config& config_;
  core::Attitude inclination_;
  Stamp inclination_due_{};
  RecorderSink sink_;
  firmware::TapeWriter tape_;
  firmware::RecordingHeadLinks links_;
  firmware::HeadDrivers drivers_;
  std::unique_ptr<firmware::SensorHead> sensor_;
  firmware::Pipeline pipeline_;
  std::unique_ptr<FixMessages> messages_;
  std::uint64_t readings_ = 0;
  RecordSummary summary_;
};

}  // namespace

tl::expected<RecordSummary, WorldError> record_drive(const RecordDrive& order,
                                                     const RecordProgress& progress) {
  firmware::Config config = order.config;
  config.head = head_of(order.scenario, config.head);
  Scenario scenario = order.scenario;
  if (!order.seconds) {
    scenario.change = StandChange::OnScanEnd;
  }
  auto head = InProcessHead::create(scenario);
  if (!head) {
    return tl::unexpected(head.error());
  }
  auto recorder =
      firmware::Recorder::create({.path = order.out, .existing = firmware::ExistingFile::Replace});
  if (!recorder) {
    return tl::unexpected(WorldError{recorder.error().message});
  }
  recorder->config(0, firmware::config_toml(config));
  Drive drive(std::move(*head), scenario.mount, *recorder, config);
  if (auto started = drive.start(); !started) {
    return tl::unexpected(started.error());
  }
  drive.run(order, progress);
  RecordSummary summary = drive.finish();
  summary.bytes = recorder->bytes();
  summary.events = recorder->events();
  if (!recorder->close()) {
    return tl::unexpected(WorldError{recorder->text()});
  }
  return summary;
}

}  // namespace slamsensor::tools
