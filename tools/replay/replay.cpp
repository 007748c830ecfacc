#include "tools/replay/replay.hpp"

#include "firmware/lcm/lcm_messages.hpp"
#include "firmware/pipeline.hpp"
#include "firmware/store/map_file.hpp"
#include "hal/stamp.hpp"
#include "tools/recording/playback.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <limits>
#include <map>
#include <utility>
#include <variant>

namespace slamsensor::tools {
namespace {

/// The making of a Replay: a pipeline, and a row for each scan that goes through it.
class ReplayRun {
 public:
  ReplayRun(const firmware::Config& config, ReplayClock clock)
      : capacities_(config.core.capacities),
        deadline_(hal::from_seconds(config.daemon.realtime.slam_deadline_s)),
        clock_(clock),
        pipeline_(config.core) {}

  [[nodiscard]] firmware::Pipeline& pipeline() { return pipeline_; }
  /// What was gathered so far.
  [[nodiscard]] Replay& result() { return result_; }

  /// Takes the fix that `localise` makes of scan `number` within the deadline that it is given, and its
  /// time; `t_s` goes to the trajectory.
  const FixRow& add(std::int64_t number, double t_s,
                    const std::function<core::Fix(const core::Deadline&)>& localise);

  /// The run with its map, whose scans are named as the rows are; a scan of before the run is -1.
  [[nodiscard]] Replay finish();

 private:
  struct Named {
    std::int64_t number = 0;
    double t_s = 0.0;
  };

  [[nodiscard]] core::Deadline deadline_from(std::chrono::steady_clock::time_point begin) const;
  [[nodiscard]] std::int64_t number_of(std::uint32_t scan) const;
  void take_map(const core::Slam& slam);

  core::Capacities capacities_;
  std::chrono::nanoseconds deadline_;
  ReplayClock clock_;
  firmware::Pipeline pipeline_;
  Replay result_;
  std::map<std::uint32_t, Named> scans_;  // by core::Fix::scan
};

std::chrono::nanoseconds steady_now(void*) noexcept {
  return std::chrono::steady_clock::now().time_since_epoch();
}

core::Deadline ReplayRun::deadline_from(std::chrono::steady_clock::time_point begin) const {
  return clock_ == ReplayClock::Off
             ? core::Deadline{}
             : core::Deadline{steady_now, nullptr, begin.time_since_epoch() + deadline_};
}

const FixRow& ReplayRun::add(std::int64_t number, double t_s,
                             const std::function<core::Fix(const core::Deadline&)>& localise) {
  const auto begin = std::chrono::steady_clock::now();
  FixRow row;
  row.scan = number;
  row.t_s = t_s;
  row.fix = localise(deadline_from(begin));
  row.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  if (const auto found = pipeline_.slam().scan_landmarks(); !found.empty()) {
    result_.landmarks.push_back({number, {found.begin(), found.end()}});
  }
  scans_[row.fix.scan] = {number, t_s};  // after a reset the scans are counted anew
  return result_.rows.emplace_back(row);
}

std::int64_t ReplayRun::number_of(std::uint32_t scan) const {
  const auto found = scans_.find(scan);
  return found != scans_.end() ? found->second.number : -1;
}

void ReplayRun::take_map(const core::Slam& slam) {
  std::vector<core::MapLandmark> landmarks(capacities_.map_landmarks);
  std::vector<core::Point2> positions_W(capacities_.map_landmarks, core::Point2::Zero());
  std::vector<core::PathPose> path(capacities_.path_poses);
  const core::MapState map = slam.copy_map({landmarks, positions_W, path});
  const std::uint32_t last_in_map = map.path.empty() ? 0 : map.path.back().scan;
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const core::MapLandmark& l = map.landmarks[i];
    result_.map.push_back({l.id, map.positions_W[i], l.xi, l.sightings, number_of(l.first_scan),
                           number_of(l.last_scan), static_cast<double>(l.sigma_m)});
    result_.matched.push_back(l.last_scan == last_in_map && l.first_scan != last_in_map);
  }
  for (const core::PathPose& pose : map.path) {
    if (const auto found = scans_.find(pose.scan); found != scans_.end()) {
      result_.path.push_back({found->second.t_s, pose.pose_W});
    }
  }
  result_.landmarks_evicted = map.landmarks_evicted;
  result_.path_thinnings = map.path_thinnings;
}

Replay ReplayRun::finish() {
  const core::Slam& slam = pipeline_.slam();
  result_.counters = slam.counters();
  result_.maps = slam.maps();
  take_map(slam);
  result_.cells_dropped = slam.detector().cells_dropped();
  result_.readings_refused = slam.detector().readings_refused();
  return std::move(result_);
}

core::Fix localise(const InputScan& scan, const core::ScanView& list_view, const core::Deadline& deadline,
                   firmware::Pipeline& pipeline) {
  const core::ScanTime time{scan.time, scan.time, scan.time, scan.time};
  return scan.is_landmark_list ? pipeline.process_landmarks(scan.landmarks, list_view, time, deadline)
                               : pipeline.process(scan.scanlines, time, deadline);
}

/// As trajectories and truths count time.
double seconds_of(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

Replay joined(Replay first, Replay second) {
  const auto put_before = [](auto& list, auto& before) {
    list.insert(list.begin(), std::make_move_iterator(before.begin()), std::make_move_iterator(before.end()));
  };
  if (second.rows.empty()) {
    second.map = std::move(first.map);
    second.matched = std::move(first.matched);
    second.path = std::move(first.path);
    second.maps = first.maps;
  }
  put_before(second.rows, first.rows);
  put_before(second.landmarks, first.landmarks);
  put_before(second.refused, first.refused);
  put_before(second.notes, first.notes);
  second.is_damaged = second.is_damaged || first.is_damaged;
  second.fixes_compared += first.fixes_compared;
  second.fixes_alike += first.fixes_alike;
  second.left_out.add(first.left_out);
  second.counters.landmarks_cut += first.counters.landmarks_cut;
  second.counters.landmarks_refused += first.counters.landmarks_refused;
  second.counters.neighbours_dropped += first.counters.neighbours_dropped;
  second.counters.searches_cut += first.counters.searches_cut;
  second.cells_dropped += first.cells_dropped;
  second.readings_refused += first.readings_refused;
  second.landmarks_evicted += first.landmarks_evicted;
  second.path_thinnings += first.path_thinnings;
  return second;
}

tl::expected<Replay, InputError> replay(const std::vector<std::filesystem::path>& inputs,
                                        const firmware::Config& config, const ReplayProgress& progress,
                                        ReplayClock clock) {
  auto source = open_scans(inputs, config);
  if (!source) {
    return tl::unexpected(source.error());
  }
  ReplayRun run(config, clock);
  Replay& result = run.result();
  result.order = (*source)->order();
  result.not_read.assign((*source)->not_read().begin(), (*source)->not_read().end());
  for (;;) {
    const auto scan = (*source)->next();
    if (!scan) {
      result.refused.push_back(scan.error().message);
      continue;
    }
    if (!*scan) {
      break;
    }
    result.points_skipped += (*scan)->points_skipped;
    result.left_out.see(**scan);
    if (!(*scan)->remark.empty()) {
      result.notes.push_back((*scan)->remark);
    }
    const FixRow& row =
        run.add((*scan)->number, seconds_of((*scan)->time), [&](const core::Deadline& deadline) {
          return localise(**scan, config.landmark_list.view(), deadline, run.pipeline());
        });
    if (progress) {
      progress(result.rows.size() + result.refused.size(), (*source)->count(), row);
    }
  }
  return run.finish();
}

namespace {

using firmware::MapOrder;

double middle_of(const core::ScanTime& time) {
  return static_cast<double>(time.middle_utc.count()) / 1e9;
}

/// Whether two fixes say the same, bit for bit.
bool are_alike(const core::Fix& a, const core::Fix& b) {
  using Message = std::array<std::uint8_t, firmware::kLcmBytes<firmware::PoseMessage>>;
  const auto bytes_of = [](const core::Fix& fix) {
    Message message{};
    firmware::FixReport report;
    report.fix = fix;
    static_cast<void>(firmware::encode_pose(report, message));
    return message;
  };
  return bytes_of(a) == bytes_of(b);
}

/// Takes the scans of the SCAN messages of `recording` into `run`: all, or those later than `after_s`.
void add_logged_scans(const RecordingFile& recording, const firmware::Config& config, double after_s,
                      const ReplayProgress& progress, ReplayRun& run) {
  ScanLog log(recording.path, recording.part);
  while (const auto scan = log.next()) {
    if (middle_of(scan->time) <= after_s) {
      continue;
    }
    const std::size_t count =
        std::min<std::size_t>(scan->landmarks.size(), config.core.detection.listed_most());
    run.result().left_out.see_list(count, scan->landmarks.size() - count);
    const auto heaviest = std::span(scan->landmarks).first(count);
    const FixRow& row = run.add(scan->number, middle_of(scan->time), [&](const core::Deadline& deadline) {
      core::ScanView view = config.landmark_list.view();
      view.shows_faces = true;  // they were detected in readings
      return run.pipeline().process_landmarks(heaviest, view, scan->time, deadline);
    });
    if (progress) {
      progress(log.messages(), static_cast<std::size_t>(recording.scan_messages), row);
    }
  }
  auto& refused = run.result().refused;
  refused.insert(refused.end(), log.refused().begin(), log.refused().end());
}

/// A tape on its way through the pipeline.
class TapeReplay {
 public:
  TapeReplay(const RecordingFile& recording, const firmware::Config& config)
      : recording_(recording), run_(config, ReplayClock::Off), orders_left_(recording.orders) {
    if (config.daemon.map_store.frozen) {
      change_maps(firmware::MapCommand::Freeze);
    }
    load_map(config.core.capacities);
  }

  /// The row of a scan that has ended, null for what else a head does.
  const FixRow* take(const firmware::HeadEvent& event) {
    if (const auto* ended = std::get_if<firmware::ScanEnded>(&event)) {
      return &localise(*ended);
    }
    static_cast<void>(run_.pipeline().take(event, utc_ahead_, {}));
    return nullptr;
  }

  /// Where the tape is damaged, the scans that it does not hold are those of the recorded messages.
  Replay finish(const TapePlayer& player, const firmware::Config& config, const ReplayProgress& progress) {
    const bool is_damaged = player.end() == TapeEnd::ChunkMissing || player.end() == TapeEnd::Broken ||
                            player.end() == TapeEnd::Cut;
    const std::size_t of_tape = run_.result().rows.size();
    if (is_damaged && recording_.scan_messages > 0) {
      const double after_s =
          of_tape > 0 ? run_.result().rows.back().t_s : -std::numeric_limits<double>::infinity();
      add_logged_scans(recording_, config, after_s, progress, run_);
    }
    if (const std::size_t more = run_.result().rows.size() - of_tape; more > 0) {
      note(recording_.path.string() + ": its tape gives " + std::to_string(of_tape) + " scans; the " +
           std::to_string(more) +
           " after them are those of its recorded scan messages, whose readings are lost");
    }
    for (const std::string& what : recording_.damage) {
      note(what);
    }
    note(recording_.path.string() + ": " + player.end_text());
    run_.result().is_damaged = !recording_.damage.empty() || player.end() != TapeEnd::Complete;
    return run_.finish();
  }

 private:
  core::MapCheck change_maps(firmware::MapCommand command, const core::MapState& state = {}) {
    return run_.pipeline().carry_out(command, state, core::Frozen::No, room_);
  }
  void note(const std::string& what) { run_.result().notes.push_back(what); }

  void load_map(const core::Capacities& capacities) {
    if (recording_.map.empty()) {
      return;
    }
    const auto file = firmware::decode_map(recording_.map, capacities);
    if (!file || !change_maps(firmware::MapCommand::Restore, file->state()).ok()) {
      note(recording_.path.string() + ": the map that the run began with cannot be loaded: " +
           (file ? "the settings have no room for it" : file.error().message));
    }
  }

  void carry_out(const MapOrder& order) {
    if (order.kind == firmware::MapCommand::Restore) {
      note("another map was loaded before scan " + std::to_string(order.scan) +
           " of the recording, which does not hold it: fixes differ from there on");
    } else {
      change_maps(order.kind);
    }
  }

  void carry_out_orders() {
    const auto is_due = [this](const MapOrder& order) { return order.scan <= run_.result().rows.size(); };
    while (!orders_left_.empty() && is_due(orders_left_.front())) {
      carry_out(orders_left_.front());
      orders_left_ = orders_left_.subspan(1);
    }
  }

  const FixRow& localise(const firmware::ScanEnded& scan) {
    carry_out_orders();
    const auto sent = recording_.fixes.find(scan.end);
    const bool is_known = sent != recording_.fixes.end();
    utc_ahead_ = is_known ? sent->second.time.end_utc - scan.end : utc_ahead_;
    const double middle_s = static_cast<double>((scan.middle + utc_ahead_).count()) / 1e9;
    const FixRow& row = run_.add(scan.scan, middle_s, [&](const core::Deadline& deadline) {
      return *run_.pipeline().take(scan, utc_ahead_, deadline);
    });
    if (is_known) {
      ++run_.result().fixes_compared;
      run_.result().fixes_alike += are_alike(row.fix, sent->second) ? 1 : 0;
    }
    return row;
  }

  const RecordingFile& recording_;
  ReplayRun run_;
  std::span<const MapOrder> orders_left_;
  firmware::MapSnapshot room_;  // of orders that a recording never has
  hal::Stamp utc_ahead_{};      // UTC less monotonic, as the last scan's fix says
};

tl::expected<Replay, InputError> replay_tape(const RecordingFile& recording, const firmware::Config& config,
                                             const ReplayProgress& progress) {
  const auto chunks = open_tape(recording);
  const auto playback = HeadPlayback::create(*chunks, config);
  if (!playback) {
    return refuse(recording.path.string(), playback.error().message);
  }
  TapeReplay run(recording, config);
  while (const auto event = (*playback)->next()) {
    const FixRow* const row = run.take(*event);
    if (row != nullptr && progress) {
      progress(static_cast<std::size_t>((*playback)->player().chunks_begun()),
               static_cast<std::size_t>(recording.chunks), *row);
    }
  }
  return run.finish((*playback)->player(), config, progress);
}

Replay replay_scan_messages(const RecordingFile& recording, const firmware::Config& config,
                            const ReplayProgress& progress) {
  ReplayRun run(config, ReplayClock::Off);
  Replay& result = run.result();
  result.notes = recording.damage;
  result.is_damaged = !recording.damage.empty();
  if (recording.is_truncated) {
    result.notes.push_back(recording.path.string() +
                           ": its last event is cut off, as when a logger is killed");
  }
  add_logged_scans(recording, config, -std::numeric_limits<double>::infinity(), progress, run);
  return run.finish();
}

}  // namespace

tl::expected<Replay, InputError> replay_recording(const RecordingFile& recording,
                                                  const firmware::Config& config,
                                                  const ReplayProgress& progress) {
  if (recording.chunks > 0) {
    return replay_tape(recording, config, progress);
  }
  return replay_scan_messages(recording, config, progress);
}

}  // namespace slamsensor::tools
