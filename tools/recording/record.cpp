#include "tools/recording/record.hpp"

#include "core/detection/levelling.hpp"
#include "core/fix.hpp"
#include "core/reading.hpp"
#include "firmware/config/list_config.hpp"
#include "firmware/lcm/lcm_publisher.hpp"
#include "firmware/output/nmea.hpp"
#include "firmware/pipeline.hpp"
#include "firmware/recording/recorder.hpp"
#include "firmware/recording/recording_links.hpp"
#include "firmware/scan/sensor_head.hpp"
#include "tools/control/ctl.hpp"
#include "tools/drive/byte_drive.hpp"
#include "tools/emulator/emulated_head.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <variant>

namespace slamsensor::tools {
namespace {

/// What an emulated sensor says of each scan, put into a recording as a live one's would be: its LCM
/// messages, which go nowhere else, and an epoch of NMEA.
class FixMessages final : private firmware::MessageTap {
 public:
  /// Both outlive the result. The error names the setting.
  [[nodiscard]] static tl::expected<std::unique_ptr<FixMessages>, WorldError> create(
      const firmware::Config& config, firmware::Recorder& recorder);

  /// Of a scan that was localised at `now`, which is UTC too.
  void write(const core::Fix& fix, std::span<const core::ScanLandmark> landmarks, hal::Stamp now);

 private:
  FixMessages(const firmware::Config& config, firmware::Recorder& recorder);
  void published(std::string_view channel, std::span<const std::uint8_t> bytes) noexcept override {
    recorder_.message(utime_us_, channel, bytes);
  }

  const firmware::Config& config_;
  firmware::Recorder& recorder_;
  std::int64_t utime_us_ = 0;                   // of what is written
  firmware::LcmSink sink_{firmware::LcmUrl{}};  // is never opened
  std::optional<firmware::LcmPublisher> publisher_;
  std::optional<firmware::GeoReference> geo_;
  std::optional<hal::Stamp> first_fix_;
};

tl::expected<std::unique_ptr<FixMessages>, WorldError> FixMessages::create(const firmware::Config& config,
                                                                           firmware::Recorder& recorder) {
  std::unique_ptr<FixMessages> messages(new FixMessages(config, recorder));
  auto publisher = firmware::LcmPublisher::create(config.daemon.lcm, messages->sink_);
  if (!publisher) {
    return tl::unexpected(WorldError{publisher.error().message});
  }
  messages->publisher_ = std::move(*publisher);
  return messages;
}

FixMessages::FixMessages(const firmware::Config& config, firmware::Recorder& recorder)
    : config_(config), recorder_(recorder) {
  if (config.datum) {
    geo_.emplace(*config.datum);
  }
  sink_.set_tap(this);
}

void FixMessages::write(const core::Fix& fix, std::span<const core::ScanLandmark> landmarks, hal::Stamp now) {
  utime_us_ = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
  firmware::FixReport report;
  report.fix = fix;
  report.source = firmware::SourceMode::Emulated;
  report.monotonic = report.uptime = now;
  first_fix_ = fix.status == core::FixStatus::Fix && !first_fix_ ? now : first_fix_;
  report.time_to_first_fix = first_fix_;
  publisher_->publish(report);
  publisher_->publish(firmware::LcmScanView{report.initialization, fix.scan, fix.time, landmarks});
  std::array<char, firmware::kNmeaEpochBytesMax> epoch{};
  const auto context =
      firmware::nmea_context(config_.nmea, geo_ ? &*geo_ : nullptr, firmware::NmeaMode::Simulated);
  recorder_.nmea(utime_us_, {epoch.data(), firmware::format_nmea(fix, context, epoch)});
}

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

/// What an inclinometer with this offset reports on a sensor that leans like the mount.
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
      const auto fix = pipeline_.take(*event, Stamp{}, core::Deadline{});
      if (const auto* line = std::get_if<firmware::Scanline>(&*event)) {
        readings_ += line->readings.size();
      } else if (const auto* ended = std::get_if<firmware::ScanEnded>(&*event)) {
        keep(*fix, *ended);
        has_ended = true;
      } else {
        summary_.scans_aborted += std::holds_alternative<firmware::ScanAborted>(*event) ? 1 : 0;
        readings_ = 0;
      }
    }
    return has_ended;
  }

  void keep(const core::Fix& fix, const firmware::ScanEnded& scan) {
    messages_->write(fix, pipeline_.slam().scan_landmarks(), head_->now());
    ++summary_.scans;
    summary_.fixes += fix.status == core::FixStatus::Fix ? 1 : 0;
    summary_.readings += std::exchange(readings_, 0);
    summary_.truth.push_back(
        {static_cast<double>(scan.middle.count()) / 1e9, head_->head().visits().back().visit.pose_W});
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

namespace {

// A connection of its own for each: the daemon may close one on which nothing is said.
CommandResult request(const LiveRecording& recording, const std::string& text, std::FILE* out) {
  CtlOptions options;
  options.socket = recording.socket;
  auto client = ControlClient::connect(options.socket);
  if (!client) {
    return tl::unexpected(client.error());
  }
  return run_request(*client, text, options, out);
}

sigset_t block_ends() {
  sigset_t ends;
  sigemptyset(&ends);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    sigaddset(&ends, signal);
  }
  ::sigprocmask(SIG_BLOCK, &ends, nullptr);
  return ends;
}

/// Until one of `ends` comes, or for so long.
void wait_for(const sigset_t& ends, std::optional<double> seconds) {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + std::chrono::duration<double>(seconds.value_or(0.0));
  for (;;) {
    const std::chrono::duration<double> left =
        seconds ? std::chrono::duration<double>(until - Clock::now()) : std::chrono::hours(1);
    if (left.count() <= 0.0) {
      return;
    }
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(left);
    const auto rest = std::chrono::duration_cast<std::chrono::nanoseconds>(left - whole);
    const timespec limit{static_cast<std::time_t>(whole.count()), static_cast<long>(rest.count())};
    if (::sigtimedwait(&ends, nullptr, &limit) > 0) {
      return;
    }
  }
}

}  // namespace

CommandResult record_live(const LiveRecording& recording, std::FILE* out) {
  const sigset_t ends = block_ends();
  const std::string start = "record start" + (recording.name.empty() ? "" : ' ' + recording.name);
  if (auto started = request(recording, start, out); !started || *started != EX_OK) {
    return started;
  }
  std::fflush(out);
  wait_for(ends, recording.seconds);
  return request(recording, "record stop", out);
}

}  // namespace slamsensor::tools
