#include "firmware/daemon/publish_loop.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kWaitMax = std::chrono::milliseconds(100);
constexpr hal::Stamp kLogPeriod = std::chrono::milliseconds(200);
constexpr hal::Stamp kStatusPeriod = std::chrono::seconds(1);  // over LCM; a person reads it
// A map is sent in bursts, so that a receiver with little room (LCM's default: 30 messages) gets all of it.
constexpr std::uint32_t kMapChunksPerTurn = 8;
// A map that does not change is repeated for those who came later.
constexpr int kMapRepeatPeriods = 6;

NmeaPublisherConfig nmea_config(const Config& config) {
  return {config.nmea, config.daemon.nmea_rate_hz, config.datum};
}

hal::Stamp nmea_period(const Config& config) {
  return std::max(hal::from_seconds(1.0 / config.daemon.nmea_rate_hz), kWaitMax);
}

std::int64_t microseconds(hal::Stamp time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time).count();
}

}  // namespace

tl::expected<std::unique_ptr<PublishLoop>, std::string> PublishLoop::create(const Config& config,
                                                                            const RunIdentity& identity,
                                                                            const PublishInlets& inlets) {
  auto url = resolve_lcm_url(config.daemon.lcm.url, std::getenv("LCM_DEFAULT_URL"));
  if (!url) {
    return tl::unexpected(url.error().message);
  }
  std::unique_ptr<PublishLoop> loop(new PublishLoop(config, identity, inlets, std::move(*url)));
  if (auto opened = loop->open_sinks(config); !opened) {
    return tl::unexpected(opened.error());
  }
  return loop;
}

PublishLoop::PublishLoop(const Config& config, const RunIdentity& identity, const PublishInlets& inlets,
                         LcmUrl url)
    : inlets_(inlets),
      identity_(identity),
      config_(config.daemon),
      tracker_(config.daemon.fix, identity.source, identity.initialization, identity.start),
      lcm_sink_(std::move(url)),
      nmea_(nmea_config(config)),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
}

tl::expected<void, std::string> PublishLoop::open_sinks(const Config& config) {
  if (config_.lcm.enabled) {
    auto publisher = LcmPublisher::create(config_.lcm, lcm_sink_);
    if (!publisher) {
      return tl::unexpected(publisher.error().message);
    }
    lcm_.emplace(std::move(*publisher));
  }
  if (!config_.nmea_serial.path.empty()) {
    auto sink = NmeaSerialSink::open(config_.nmea_serial, nmea_period(config));
    if (!sink) {
      return tl::unexpected(sink.error().message);
    }
    serial_ = std::move(*sink);
    static_cast<void>(nmea_.add(*serial_));
  }
  if (config_.nmea_tcp.enabled) {
    auto server = NmeaTcpServer::create(config_.nmea_tcp);
    if (!server) {
      return tl::unexpected(server.error().message);
    }
    tcp_ = std::move(*server);
    static_cast<void>(nmea_.add(*tcp_));
  }
  return {};
}

void PublishLoop::step(const OutputTime& now) {
  take_changes();
  take_statuses(now.monotonic);
  if (recording_) {
    recording_->save(microseconds(now.utc));
  }
  if (lcm_) {
    lcm_sink_.service(now.monotonic);
  }
  FixMessage message;
  while (inlets_.slam.fixes.pop(message)) {
    answer(message, now);
  }
  report(now);
  publish_status(now);
  publish_map(now);
  drive_gpio(now.monotonic);
  log_changes(now.monotonic);
  const std::scoped_lock lock(mutex_);
  shared_status_ = status_;
}

void PublishLoop::take_changes() {
  Changes changes;
  {
    const std::scoped_lock lock(mutex_);
    changes = std::exchange(changes_, {});
  }
  if (changes.config) {
    config_ = changes.config->daemon;
    tracker_.set_config(config_.fix);
    nmea_.set_config(nmea_config(*changes.config));
    if (serial_) {
      serial_->set_patience(nmea_period(*changes.config));
    }
  }
  if (changes.facts) {
    if (changes.facts->maps_replaced != facts_.maps_replaced) {
      tracker_.on_new_map();
    }
    facts_ = *changes.facts;
  }
  if (changes.recording) {
    if (recording_) {
      nmea_.take_out(*recording_);
    }
    recording_ = std::move(*changes.recording);
    lcm_sink_.set_tap(recording_.get());
    if (recording_) {
      static_cast<void>(nmea_.add(*recording_));
    }
  }
}

void PublishLoop::take_statuses(hal::Stamp now) {
  if (inlets_.head.refresh()) {
    status_.head = inlets_.head.value();
    tracker_.on_head(status_.head);
  }
  if (inlets_.slam.status.refresh()) {
    status_.slam = inlets_.slam.status.value();
  }
  status_.map_name = facts_.map_name;
  status_.map_saved_ago = facts_.map_saved ? now - *facts_.map_saved : hal::kNever;
  status_.map_unsaved = facts_.map_unsaved;
  status_.realtime = facts_.realtime;
  status_.recording = recording_ != nullptr && recording_->is_recording();
}

/// A scan's fix goes to all outputs; LCM gets its rivals and what was seen with it.
void PublishLoop::answer(const FixMessage& message, const OutputTime& now) {
  tracker_.on_fix(message.fix, message.made);
  told_.reset();  // each fix is sent, the same one too
  report(now);
  answer_last_ = hal::monotonic_now() - message.scan_ended;
  answer_max_ = std::max(answer_max_, answer_last_);
  if (lcm_) {
    lcm_->publish(
        LcmRivalsView{identity_.initialization, message.fix.scan, message.fix.time, message.rivals});
    lcm_->publish(LcmScanView{identity_.initialization, message.fix.scan, message.fix.time, message.seen()});
  }
  if (inlets_.gpio != nullptr && status_.state == SensorState::Fixed) {
    inlets_.gpio->on_fix(now.monotonic);
  }
}

/// NMEA by its epochs; LCM when the fix is another: one that is withdrawn between two scans (stale, a device
/// lost) is reported at once, and so is another reason why there is none.
void PublishLoop::report(const OutputTime& now) {
  refresh_status(now.monotonic);
  nmea_.step(now, status_);
  const core::Fix& fix = status_.report.fix;
  const std::tuple state{fix.status, fix.reason, core::has_pose(fix)};
  if (lcm_ && told_ != state) {
    lcm_->publish(status_.report);
  }
  told_ = state;
}

void PublishLoop::refresh_status(hal::Stamp now) {
  status_.state = tracker_.state(now);
  status_.report = tracker_.report(now);
  status_.outputs.size = 0;
  nmea_.append_counters(status_.outputs);
  status_.outputs.append(lcm_sink_.counters());
  if (inlets_.gpio != nullptr) {
    status_.outputs.append(inlets_.gpio->counters());
  }
  status_.outputs.append(facts_.counters.all());
  const std::array<hal::Counter, 2> answers = {
      {{"answer_last_us", static_cast<std::uint64_t>(microseconds(answer_last_))},
       {"answer_max_us", static_cast<std::uint64_t>(microseconds(answer_max_))}}};
  status_.outputs.append(answers);
}

void PublishLoop::publish_status(const OutputTime& now) {
  if (!lcm_ || now.monotonic < status_due_) {
    return;
  }
  status_due_ = now.monotonic + kStatusPeriod;
  lcm_->publish(status_, now.utc);
}

void PublishLoop::publish_map(const OutputTime& now) {
  if (!lcm_ || (!map_chunk_ && !begin_map(now.monotonic))) {
    return;
  }
  const core::MapState state = map_.state();
  const LcmMapView view{now.utc, identity_.initialization, map_.revision(), state.landmarks,
                        state.positions_W};
  map_chunk_ = lcm_->publish(view, map_chunk_.value_or(0), kMapChunksPerTurn);
}

/// Whether the map is to be sent now: a copy of it is there then.
bool PublishLoop::begin_map(hal::Stamp now) {
  MapOutlet& outlet = inlets_.slam.map;
  const bool is_changed = now >= map_due_ && outlet.revision() != map_.revision();
  const bool is_repeat = now >= map_repeat_ && outlet.revision() != 0;
  if (!is_changed && !is_repeat) {
    return false;
  }
  if (outlet.copied() == map_.revision() && outlet.revision() != outlet.copied()) {
    outlet.ask();  // it will be there at one of the next steps
    return false;
  }
  if (!outlet.try_read([&](const MapSnapshot& map) { map_ = map; })) {
    return false;
  }
  map_due_ = now + hal::from_seconds(config_.lcm.map_period_s);
  map_repeat_ = now + kMapRepeatPeriods * hal::from_seconds(config_.lcm.map_period_s);
  return true;
}

void PublishLoop::drive_gpio(hal::Stamp now) {
  if (inlets_.gpio != nullptr) {
    inlets_.gpio->step(status_.state, now);
  }
}

void PublishLoop::log_changes(hal::Stamp now) {
  if (now < log_due_) {
    return;
  }
  log_due_ = now + kLogPeriod;
  for (const LogEntry& entry : logger_.compare(status_)) {
    inlets_.log.write(entry.level, entry.text);
  }
  log_problem("LCM", lcm_ ? lcm_sink_.problem() : std::string_view(), lcm_problem_);
  log_problem("NMEA", nmea_.problem(), nmea_problem_);
  if (const std::string refusals = tcp_ ? tcp_->take_refusals(now) : ""; !refusals.empty()) {
    inlets_.log.warning(refusals);
  }
}

/// A problem of an output when it comes, when it changes and when it goes.
void PublishLoop::log_problem(std::string_view output, std::string_view problem, std::string& last) {
  if (problem == last) {
    return;
  }
  last = problem;
  if (problem.empty()) {
    inlets_.log.notice(std::string(output) + " output goes on");
  } else {
    inlets_.log.warning(std::string(output) + ": " + std::string(problem));
  }
}

void PublishLoop::wait(const OutputTime& now) {
  std::array<pollfd, 80> fds{};
  fds[0] = {wake_.get(), POLLIN, 0};
  const std::size_t count = 1 + nmea_.poll_on(std::span(fds).subspan(1));
  hal::Stamp wait = std::min(nmea_.wait(now), kWaitMax);
  if (map_chunk_) {
    wait = std::min<hal::Stamp>(wait, std::chrono::milliseconds(5));
  }
  if (inlets_.gpio != nullptr) {
    wait = std::min(wait, inlets_.gpio->next_change(now.monotonic) - now.monotonic);
  }
  // Rounded up: a wait that ends too early makes the loop spin.
  const auto timeout = std::chrono::ceil<std::chrono::milliseconds>(std::max(wait, hal::Stamp{}));
  poll(fds.data(), count, static_cast<int>(timeout.count()));
  if ((fds[0].revents & POLLIN) != 0) {
    std::uint64_t wakes = 0;
    static_cast<void>(!read(wake_.get(), &wakes, sizeof wakes));
  }
}

void PublishLoop::wake() noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(!write(wake_.get(), &one, sizeof one));
}

SensorStatus PublishLoop::status() const {
  const std::scoped_lock lock(mutex_);
  return shared_status_;
}

void PublishLoop::set_config(const Config& config) {
  const std::scoped_lock lock(mutex_);
  changes_.config = config;
}

void PublishLoop::set_facts(const SupervisorFacts& facts) {
  const std::scoped_lock lock(mutex_);
  changes_.facts = facts;
}

void PublishLoop::begin_recording(std::shared_ptr<RecordingSession> session) {
  const std::scoped_lock lock(mutex_);
  changes_.recording = std::move(session);
}

void PublishLoop::end_recording() {
  const std::scoped_lock lock(mutex_);
  changes_.recording = nullptr;
}

}  // namespace slamsensor::firmware
