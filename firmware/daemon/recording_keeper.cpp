#include "firmware/daemon/recording_keeper.hpp"

#include "firmware/config/list_config.hpp"
#include "firmware/store/map_names.hpp"
#include "hal/clock.hpp"

#include <filesystem>
#include <system_error>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr std::uint64_t kMegabyte = 1'000'000;

std::int64_t microseconds(std::chrono::nanoseconds time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time).count();
}

}  // namespace

RecordingKeeper::RecordingKeeper(const Config& config, SensorThreads& threads, MapKeeper& maps, Log& log)
    : config_(config), threads_(threads), maps_(maps), log_(log) {
  maps_.set_order_tap([this](MapCommand kind, const SlamAnswer& answer) { on_map_order(kind, answer); });
}

ControlOutcome RecordingKeeper::start(ControlToken token, std::string_view name, const OutputTime& now) {
  if (phase_ != Phase::Idle) {
    return refusal(ControlErrorCode::Refused, "a recording is under way; record stop ends it");
  }
  token_ = token;
  name_ = name.empty() ? utc_name(microseconds(now.utc) / 1'000'000) : std::string(name);
  threads_.stop_scanning();
  phase_ = Phase::Draining;
  return std::nullopt;
}

ControlOutcome RecordingKeeper::stop(ControlToken token) {
  if (phase_ != Phase::Recording) {
    return refusal(ControlErrorCode::Refused, "no recording is under way; record start begins one");
  }
  token_ = token;
  leave();
  return std::nullopt;
}

ControlResult RecordingKeeper::status() const {
  return ControlReply{session_ ? session_->text() : "no recording is under way", {}};
}

std::optional<MapKeeper::Answer> RecordingKeeper::step(const OutputTime& now) {
  switch (phase_) {
    case Phase::Idle:
      return std::nullopt;
    case Phase::Draining:
      if (threads_.is_slam_idle() && threads_.slam_orders().give({MapCommand::DropRivals, {}})) {
        threads_.wake_slam();
        phase_ = Phase::Settling;
      }
      return std::nullopt;
    case Phase::Settling:
      return settle(now);
    case Phase::Recording:
      if (!session_->is_recording()) {
        log_.warning("recording ended: " + session_->text());
        leave();
      }
      return std::nullopt;
    case Phase::Ending:
      if (session_.use_count() > 1) {
        return std::nullopt;
      }
      phase_ = Phase::Idle;
      return answer(ControlReply{std::exchange(session_, nullptr)->finish(microseconds(now.utc)), {}});
  }
  return std::nullopt;
}

/// The recording begins with the map that the SLAM thread goes on with.
std::optional<MapKeeper::Answer> RecordingKeeper::settle(const OutputTime& now) {
  const auto settled = threads_.slam_orders().answer();
  if (!settled) {
    return std::nullopt;
  }
  scans_before_ = settled->scans;
  return answer(begin(now));
}

ControlResult RecordingKeeper::begin(const OutputTime& now) {
  const std::filesystem::path folder = config_.daemon.record.directory;
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);  // Recorder reports what is wrong with it
  const std::filesystem::path path = folder / (name_ + ".lcm");
  auto recorder =
      Recorder::create({.path = path, .bytes_max = config_.daemon.record.size_max_mb * kMegabyte});
  TapeWriter* tape = nullptr;
  if (recorder) {
    Config config = config_;
    config.daemon.map_store.frozen = maps_.is_frozen();  // maybe by request
    recorder->config(microseconds(now.utc), config_toml(config));
    if (const auto map = maps_.encoded(); !map.empty()) {
      recorder->map(microseconds(now.utc), map);
    }
    session_ = std::make_shared<RecordingSession>(std::move(*recorder), path);
    threads_.publish().begin_recording(session_);
    tape = &session_->tape();
  }
  phase_ = recorder ? Phase::Recording : Phase::Idle;
  if (auto restarted = threads_.restart_head(tape); !restarted) {
    failure_ = restarted.error();
  }
  if (!recorder) {
    return refusal(ControlErrorCode::Failed, recorder.error().message);
  }
  return ControlReply{"recording to " + path.string() + "; the devices start over", {}};
}

void RecordingKeeper::leave() {
  if (auto left = threads_.leave_tape(); !left) {
    failure_ = left.error();
  }
  threads_.publish().end_recording();
  phase_ = Phase::Ending;
}

void RecordingKeeper::finish_at_end(const OutputTime& now) {
  if (session_) {
    log_.notice("recording ended: " + std::exchange(session_, nullptr)->finish(microseconds(now.utc)));
  }
}

std::optional<MapKeeper::Answer> RecordingKeeper::answer(ControlResult result) {
  if (result) {
    log_.notice(result->summary);
  } else {
    log_.error(result.error().message);
  }
  if (token_ == 0) {
    return std::nullopt;
  }
  return MapKeeper::Answer{std::exchange(token_, 0), std::move(result)};
}

void RecordingKeeper::on_map_order(MapCommand kind, const SlamAnswer& answer) {
  if (session_ && phase_ == Phase::Recording) {
    const hal::Stamp utc = hal::monotonic_now() + hal::realtime_ahead();
    session_->order(microseconds(utc), {kind, answer.scans - scans_before_});
  }
}

}  // namespace slamsensor::firmware
