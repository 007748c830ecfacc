#include "firmware/daemon/daemon.hpp"

#include "firmware/daemon/realtime.hpp"
#include "firmware/status/sensor_status.hpp"
#include "firmware/status/status_text.hpp"
#include "hal/clock.hpp"

#include <array>
#include <poll.h>
#include <sys/random.h>
#include <utility>
#include <vector>

namespace slamsensor::firmware {
namespace {

constexpr int kTurn_ms = 50;
constexpr hal::Stamp kTellPeriod = std::chrono::seconds(1);
constexpr hal::Stamp kFactsPeriod = std::chrono::milliseconds(200);
constexpr hal::Stamp kExtendPeriod = std::chrono::seconds(10);

OutputTime output_now() {
  const hal::Stamp now = hal::monotonic_now();
  return {now, now + hal::realtime_ahead()};
}

/// Differs from start to start, also where the clock was set back or never set.
std::uint64_t draw_initialization() {
  std::uint64_t value = 0;
  if (getrandom(&value, sizeof value, GRND_NONBLOCK) != sizeof value) {
    value = static_cast<std::uint64_t>(output_now().utc.count());
  }
  return value & INT64_MAX;  // LCM's integers are signed
}

/// Devices, outputs, map, recording and configuration, and every client that may connect.
std::uint64_t open_files_needed(const Config& config) {
  constexpr std::uint64_t kOwn = 32;
  return kOwn + kControlClientsMax +
         (config.daemon.nmea_tcp.enabled ? config.daemon.nmea_tcp.clients_max : 0);
}

tl::unexpected<StartFailure> failure(ExitReason reason, std::string message) {
  return tl::unexpected(StartFailure{reason, std::move(message)});
}

}  // namespace

tl::expected<std::unique_ptr<Daemon>, StartFailure> Daemon::create(LayeredConfig layers, SourceMode source,
                                                                   Log& log) {
  auto config = std::make_unique<LayeredConfig>(std::move(layers));
  if (auto raised = raise_open_files(open_files_needed(config->current().config)); !raised) {
    return failure(ExitReason::NoResources, raised.error());
  }
  auto signals = Signals::create();
  if (!signals) {
    return failure(ExitReason::NoResources, signals.error().message);
  }
  const hal::Stamp now = hal::monotonic_now();
  auto threads = SensorThreads::create(config->current().config, {source, draw_initialization(), now}, log);
  if (!threads) {
    return failure(ExitReason::Config, threads.error());
  }
  std::unique_ptr<Daemon> daemon(
      new Daemon(std::move(config), std::move(*signals), std::move(*threads), log, now));
  auto server = ControlServer::create({.socket = daemon->config_->current().config.daemon.control.socket},
                                      [&control = daemon->control_](const ControlRequest& request) {
                                        return request.verb->run(request, control);
                                      });
  if (!server) {
    return failure(ExitReason::Unavailable, server.error().message);
  }
  daemon->server_ = std::move(*server);
  return daemon;
}

Daemon::Daemon(std::unique_ptr<LayeredConfig> config, Signals signals, std::unique_ptr<SensorThreads> threads,
               Log& log, hal::Stamp now)
    : config_(std::move(config)),
      log_(log),
      signals_(std::move(signals)),
      notifier_(ServiceNotifier::from_environment()),
      threads_(std::move(threads)),
      maps_(config_->current().config, *threads_, log, now),
      recordings_(config_->current().config, *threads_, maps_, log),
      control_{*config_, *threads_, maps_, recordings_, log},
      watchdog_(threads_->heartbeats(), notifier_) {
}

tl::expected<void, StartFailure> Daemon::run() {
  log_.notice("slamsensord " + std::string(kVersion) + " starts");
  maps_.load_at_start();
  if (auto started = threads_->start(); !started) {
    return failure(ExitReason::NoPermission, started.error());
  }
  log_.notice(threads_->is_realtime() ? "running in real time, memory locked"
                                      : "running without real-time rights");
  while (!is_stopping_ && !recordings_.failure()) {
    turn(output_now());
    wait();
  }
  return stop();
}

void Daemon::turn(const OutputTime& now) {
  take_signals(now);
  server_->step(now.monotonic);
  const std::uint32_t replaced = maps_.replaced();
  for (const MapKeeper::Answer& answer : maps_.step(now)) {
    server_->complete(answer.token, answer.result);
  }
  if (maps_.replaced() != replaced) {
    apply_config(control_);  // the map's datum may be in force now
    facts_told_ = {};
  }
  if (const auto answer = recordings_.step(now)) {
    server_->complete(answer->token, answer->result);
  }
  tell_facts(now.monotonic);
  tell_manager(now.monotonic);
}

void Daemon::wait() {
  std::vector<pollfd> interest{{signals_.fd(), POLLIN, 0}};
  server_->append_interest(interest);
  poll(interest.data(), interest.size(), kTurn_ms);
}

void Daemon::take_signals(const OutputTime& now) {
  while (const auto order = signals_.take()) {
    switch (*order) {
      case Order::Stop:
        is_stopping_ = true;
        break;
      case Order::Reload:
        reload(now);
        break;
      case Order::SaveMap:
        maps_.save_now(now);
        break;
    }
  }
}

void Daemon::reload(const OutputTime& now) {
  notifier_.reloading(now.monotonic);
  if (reload_config(control_)) {
    log_.notice("configuration read again");
  } else {
    log_.error("the configuration is not read again: it has mistakes; the one in force stays");
  }
  notifier_.ready();
}

/// Ready is said when the devices have answered; until then the manager is asked for patience.
void Daemon::tell_manager(hal::Stamp now) {
  if (const auto stalled = watchdog_.step(now)) {
    log_.error("thread " + std::string(stalled->name) + " has made no progress for " +
               std::to_string(std::chrono::duration_cast<std::chrono::seconds>(stalled->silence).count()) +
               " s");
  }
  if (now - told_ < kTellPeriod) {
    return;
  }
  told_ = now;
  log_.tick();
  const SensorStatus status = threads_->publish().status();
  notifier_.status(status_line(status));
  if (is_ready_) {
    return;
  }
  if (status.state != SensorState::Starting) {
    is_ready_ = true;
    notifier_.ready();
  } else if (now - extended_ >= kExtendPeriod || extended_ == hal::Stamp{}) {
    extended_ = now;
    notifier_.extend_timeout(3 * kExtendPeriod);
  }
}

void Daemon::tell_facts(hal::Stamp now) {
  if (facts_told_ != hal::Stamp{} && now - facts_told_ < kFactsPeriod) {
    return;
  }
  facts_told_ = now;
  SupervisorFacts facts;
  facts.map_name = hal::FixedText<64>(maps_.name());
  facts.map_saved = maps_.saved();
  facts.map_unsaved = maps_.is_unsaved();
  facts.realtime = threads_->is_realtime();
  facts.maps_replaced = maps_.replaced();
  facts.counters.append(server_->counters());
  facts.counters.append(std::array{hal::Counter{"log_lines_lost", log_.lost()}});
  threads_->publish().set_facts(facts);
}

tl::expected<void, StartFailure> Daemon::stop() {
  notifier_.stopping();
  log_.notice("stopping");
  threads_->stop();
  const OutputTime now = output_now();
  recordings_.finish_at_end(now);
  maps_.save_at_end(now);
  log_.flush();
  if (const auto& lost = recordings_.failure()) {
    return failure(ExitReason::Fault, *lost);
  }
  return {};
}

}  // namespace slamsensor::firmware
