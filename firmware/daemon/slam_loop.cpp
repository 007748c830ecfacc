#include "firmware/daemon/slam_loop.hpp"

#include <algorithm>
#include <string_view>
#include <variant>

namespace slamsensor::firmware {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"scans_localised", "scans_given_up", "fixes_dropped",
                                                    "scanlines_lacking"};

bool is_stopping(const SlamClock& clock) noexcept {
  return clock.is_stopping != nullptr && clock.is_stopping->load(std::memory_order_relaxed);
}

/// The time for a search, which is over when the thread is to end.
hal::Stamp search_time(void* context) noexcept {
  const auto& clock = *static_cast<const SlamClock*>(context);
  return is_stopping(clock) ? hal::kNever : clock.monotonic(nullptr);
}

core::ScanTime scan_time(const ScanEnded& scan, hal::Stamp utc_ahead) {
  return {scan.begin + utc_ahead, scan.middle + utc_ahead, scan.end + utc_ahead, scan.end};
}

}  // namespace

SlamLoop::SlamLoop(const Config& config, ScanQueue& scans, SlamOrders& orders, SlamOutlets& outlets)
    : deadline_(hal::from_seconds(config.daemon.realtime.slam_deadline_s)),
      pipeline_(config.core),
      scans_(scans),
      orders_(orders),
      outlets_(outlets),
      counters_(kNames) {
  pipeline_.slam().set_frozen(config.daemon.map_store.frozen ? core::Frozen::Yes : core::Frozen::No);
  post_status();
}

bool SlamLoop::step(const SlamClock& clock) noexcept {
  if (const SlamOrder* const order = orders_.order()) {
    carry_out(*order);
    return true;
  }
  if (const auto message = scans_.take()) {
    take(*message, clock);
    return true;
  }
  return false;
}

void SlamLoop::carry_out(const SlamOrder& order) noexcept {
  core::MapCheck check;
  switch (order.kind) {
    case SlamOrder::Kind::Reset:
      pipeline_.slam().reset();
      break;
    case SlamOrder::Kind::Restore:
      check = pipeline_.slam().restore(order.state);
      if (check.ok() && order.frozen == core::Frozen::Yes) {
        pipeline_.slam().set_frozen(core::Frozen::Yes);
      }
      break;
    case SlamOrder::Kind::Freeze:
      pipeline_.slam().set_frozen(core::Frozen::Yes);
      break;
    case SlamOrder::Kind::Unfreeze:
      pipeline_.slam().set_frozen(core::Frozen::No);
      break;
    case SlamOrder::Kind::DropRivals:
      begin_from_home_map();
      break;
  }
  post_map();
  post_status();
  orders_.done({check, pipeline_.slam().revision(), status_.scans});
}

/// Goes on with what a recording holds of the maps, as its replay will.
void SlamLoop::begin_from_home_map() noexcept {
  core::Slam& slam = pipeline_.slam();
  if (slam.atlas() == nullptr) {
    slam.drop_rivals();
    return;
  }
  // Not all that a map is restored from can be copied from the restored one again: the second time it is the
  // same.
  for (int time = 0; time < 2; ++time) {
    MapSnapshot& map = outlets_.map.draft();
    map.take(slam);
    slam.reset();
    if (!map.empty()) {
      static_cast<void>(slam.restore(map.state()));
    }
  }
}

void SlamLoop::take(const ScanItem& message, const SlamClock& clock) noexcept {
  if (const auto* line = std::get_if<QueuedScanline>(&message)) {
    pipeline_.slam().add_scanline(line->readings);
    ++lines_;
  } else if (const auto* ended = std::get_if<QueuedEnd>(&message)) {
    localise(*ended, clock);
  } else if (const auto* aborted = std::get_if<ScanAborted>(&message)) {
    give_up(*aborted, clock);
  } else {
    pipeline_.slam().drop_scan();  // of a scan whose end was lost
    lines_ = 0;
  }
}

void SlamLoop::localise(const QueuedEnd& end, const SlamClock& clock) noexcept {
  const ScanEnded& scan = end.scan;
  const hal::Stamp begun = clock.monotonic(nullptr);
  SlamClock lent = clock;
  const core::Deadline deadline{search_time, &lent, begun + deadline_};
  const core::Fix fix = pipeline_.slam().finish_scan(scan_time(scan, clock.utc_ahead), deadline);
  if (is_stopping(clock) && fix.search_end == core::SearchEnd::Deadline) {
    lines_ = 0;
    return;  // cut by the end of the daemon: no result
  }
  counters_.count(SlamEvent::ScansLocalised);
  counters_.count(SlamEvent::ScanlinesLacking, scan.lines - std::min(lines_, scan.lines));
  lines_ = 0;
  const auto landmarks = pipeline_.slam().scan_landmarks();
  message_.landmark_count =
      static_cast<std::uint32_t>(std::min<std::size_t>(landmarks.size(), message_.landmarks.size()));
  std::copy_n(landmarks.begin(), message_.landmark_count, message_.landmarks.begin());
  message_.scan_ended = end.queued;

  const hal::Stamp now = clock.monotonic(nullptr);
  status_.process_last = now - begun;
  status_.process_max = std::max(status_.process_max, status_.process_last);
  ++status_.scans;
  status_.fixes += fix.status == core::FixStatus::Fix ? 1 : 0;
  send(fix, now);
  post_map();
  post_status();
}

void SlamLoop::give_up(const ScanAborted& scan, const SlamClock& clock) noexcept {
  pipeline_.slam().drop_scan();
  lines_ = 0;
  counters_.count(SlamEvent::ScansGivenUp);
  const bool is_moved = scan.reason == ScanAbort::CarrierMoved;
  if (is_moved || scan.reason == ScanAbort::TimingInDoubt) {
    // The carrier moved, or what was seen cannot be relied on: the last fix is void.
    const hal::Stamp now = clock.monotonic(nullptr);
    core::Fix fix;
    fix.reason = is_moved ? core::FixReason::Moved : core::FixReason::Timing;
    fix.scan = status_.scans;
    fix.time = {now + clock.utc_ahead, now + clock.utc_ahead, now + clock.utc_ahead, now};
    message_.landmark_count = 0;
    message_.scan_ended = now;
    send(fix, now);
  }
  post_status();
}

void SlamLoop::send(const core::Fix& fix, hal::Stamp now) noexcept {
  message_.fix = fix;
  message_.made = now;
  if (!outlets_.fixes.push(message_)) {
    counters_.count(SlamEvent::FixesDropped);
  }
}

void SlamLoop::post_map() noexcept {
  const core::Slam& slam = pipeline_.slam();
  if (slam.revision() == revision_posted_) {
    return;
  }
  revision_posted_ = slam.revision();
  outlets_.map.draft().take(slam);
  outlets_.map.post();
}

void SlamLoop::post_status() noexcept {
  const core::Slam& slam = pipeline_.slam();
  const core::MapsSummary maps = slam.maps();
  status_.landmarks = maps.home_landmarks;
  status_.hypotheses = maps.hypotheses;
  status_.local_maps = maps.local_maps;
  status_.local_landmarks = maps.local_landmarks;
  status_.map_revision = slam.revision();
  status_.frozen = slam.frozen() == core::Frozen::Yes;
  status_.counters.size = 0;
  status_.counters.append(counters_.all());
  const core::Counters& events = slam.counters();
  const std::array<hal::Counter, 6> more = {
      {{"landmarks_cut", events.landmarks_cut},
       {"landmarks_refused", events.landmarks_refused},
       {"neighbours_dropped", events.neighbours_dropped},
       {"searches_cut", events.searches_cut},
       {"cells_dropped", pipeline_.slam().detector().cells_dropped()},
       {"readings_refused", pipeline_.slam().detector().readings_refused()}}};
  status_.counters.append(more);
  outlets_.status.draft() = status_;
  outlets_.status.post();
}

}  // namespace slamsensor::firmware
