#include "tools/replay/replay_recording.hpp"

#include "firmware/lcm/pose_message.hpp"
#include "firmware/store/map_file.hpp"
#include "tools/recording/head_playback.hpp"
#include "tools/recording/scan_log.hpp"
#include "tools/replay/replay_run.hpp"

#include <algorithm>
#include <array>
#include <variant>

namespace slamsensor::tools {
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

/// A tape on its way through the pipeline.
class TapeReplay {
 public:
  TapeReplay(const RecordingFile& recording, const firmware::Config& config)
      : recording_(recording), run_(config, ReplayClock::Off), orders_left_(recording.orders) {
    slam().set_frozen(config.daemon.map_store.frozen ? core::Frozen::Yes : core::Frozen::No);
    load_map(config.core.capacities);
  }

  /// The row of a scan that has ended, null for what else a head does.
  const FixRow* take(const firmware::HeadEvent& event) {
    if (const auto* line = std::get_if<firmware::Scanline>(&event)) {
      slam().add_scanline(line->readings);
    } else if (const auto* ended = std::get_if<firmware::ScanEnded>(&event)) {
      return &localise(*ended);
    } else {
      slam().drop_scan();
    }
    return nullptr;
  }

  Replay finish(const TapePlayer& player) {
    for (const std::string& what : recording_.damage) {
      note(what);
    }
    note(recording_.path.string() + ": " + player.end_text());
    run_.result().is_damaged = !recording_.damage.empty() || player.end() != TapeEnd::Complete;
    return run_.finish();
  }

 private:
  core::Slam& slam() { return run_.pipeline().slam(); }
  void note(const std::string& what) { run_.result().notes.push_back(what); }

  void load_map(const core::Capacities& capacities) {
    if (recording_.map.empty()) {
      return;
    }
    const auto file = firmware::decode_map(recording_.map, capacities);
    if (!file || !slam().restore(file->state()).ok()) {
      note(recording_.path.string() + ": the map that the run began with cannot be loaded: " +
           (file ? "the settings have no room for it" : file.error().message));
    }
  }

  void carry_out(const MapOrder& order) {
    switch (order.kind) {
      case MapOrder::Kind::Reset:
        return slam().reset();
      case MapOrder::Kind::Freeze:
        return slam().set_frozen(core::Frozen::Yes);
      case MapOrder::Kind::Unfreeze:
        return slam().set_frozen(core::Frozen::No);
      case MapOrder::Kind::Load:
        note("another map was loaded before scan " + std::to_string(order.scan) +
             " of the recording, which does not hold it: fixes differ from there on");
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
    const core::ScanTime time{scan.begin + utc_ahead_, scan.middle + utc_ahead_, scan.end + utc_ahead_,
                              scan.end};
    const FixRow& row = run_.add(scan.scan, middle_of(time), [&](const core::Deadline& deadline) {
      return slam().finish_scan(time, deadline);
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
  hal::Stamp utc_ahead_{};  // UTC less monotonic, as the last scan's fix says
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
  return run.finish((*playback)->player());
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
  ScanLog log(recording.path, recording.part);
  while (const auto scan = log.next()) {
    const std::size_t count =
        std::min<std::size_t>(scan->landmarks.size(), config.core.detection.landmarks_max);
    const auto heaviest = std::span(scan->landmarks).first(count);
    const FixRow& row = run.add(scan->number, middle_of(scan->time), [&](const core::Deadline& deadline) {
      return run.pipeline().process_landmarks(heaviest, config.landmark_list.view(), scan->time, deadline);
    });
    if (progress) {
      progress(log.messages(), static_cast<std::size_t>(recording.scan_messages), row);
    }
  }
  result.refused = log.refused();
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
