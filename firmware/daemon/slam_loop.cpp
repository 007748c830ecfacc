#include "firmware/daemon/slam_loop.hpp"

#include <algorithm>
#include <string_view>
#include <thread>
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

/// The other places that the search of an ambiguous scan found in the map of the answer, the likeliest first;
/// none where the paper's rule is chosen, which keeps no places.
RivalPlaces rivals_of(const core::Slam& slam, const core::Fix& fix,
                      const core::AcceptanceConfig& config) noexcept {
  RivalPlaces rivals;
  const core::Atlas* const atlas = slam.atlas();
  if (atlas == nullptr || fix.status != core::FixStatus::Ambiguous || fix.map != fix.home) {
    return rivals;
  }
  core::FixedVector<const core::Weighed*, core::kCandidatesMax> order;
  for (const core::Weighed& place : atlas->weighed()) {
    const bool is_likelier_than_none = place.evidence.ln_bayes > 0.0 && place.candidate.matches.size() >= 3;
    if (place.candidate.map == atlas->home_slot() && is_likelier_than_none) {
      static_cast<void>(order.try_push_back(&place));
    }
  }
  std::sort(order.begin(), order.end(), [](const core::Weighed* a, const core::Weighed* b) {
    return a->evidence.ln_bayes > b->evidence.ln_bayes;
  });
  for (const core::Weighed* const place : order) {
    const core::Pose2& pose_W = place->candidate.pose_W;
    const auto is_elsewhere = [&](const RivalPlace& rival) {
      return core::elsewhere(rival.pose_W, pose_W, config);
    };
    if (core::elsewhere(fix.pose_W, pose_W, config) &&
        std::all_of(rivals.begin(), rivals.end(), is_elsewhere)) {
      static_cast<void>(
          rivals.try_push_back({pose_W, static_cast<std::uint32_t>(place->candidate.matches.size())}));
    }
  }
  return rivals;
}

}  // namespace

void MapOutlet::post(const core::Slam& slam) noexcept {
  map_.take(slam);
  set_revision(map_.revision());
  copied_.store(map_.revision(), std::memory_order_release);
  phase_.store(Phase::Free, std::memory_order_release);
}

void MapOutlet::ask() noexcept {
  if (copied() != revision()) {
    static_cast<void>(turn(Phase::Free, Phase::Asked));
  }
}

/// Ends with the room in the hands of the readers.
void MapOutlet::wait_for_newest() {
  constexpr std::chrono::milliseconds kNap{1};
  const auto give_up = std::chrono::steady_clock::now() + kPatience;
  const bool is_stale = copied() != revision();
  const std::uint64_t before = copied();
  while (true) {
    const bool is_late = std::chrono::steady_clock::now() > give_up;
    if ((!is_stale || is_late || copied() != before) &&
        (turn(Phase::Free, Phase::Readers) || (is_late && turn(Phase::Asked, Phase::Readers)))) {
      return;
    }
    ask();
    std::this_thread::sleep_for(kNap);
  }
}

SlamLoop::SlamLoop(const Config& config, ScanQueue& scans, SlamOrders& orders, SlamOutlets& outlets)
    : deadline_(hal::from_seconds(config.daemon.realtime.slam_deadline_s)),
      acceptance_(config.core.acceptance),
      pipeline_(config.core),
      scans_(scans),
      orders_(orders),
      outlets_(outlets),
      counters_(kNames) {
  if (config.daemon.map_store.frozen) {
    pipeline_.carry_out(MapCommand::Freeze, {}, core::Frozen::Yes, outlets.map.room());
  }
  post_status();
}

bool SlamLoop::step(const SlamClock& clock) noexcept {
  if (const SlamOrder* const order = orders_.order()) {
    return carry_out(*order);
  }
  if (const auto event = scans_.take()) {
    take(*event, clock);
    return true;
  }
  if (outlets_.map.is_asked()) {
    post_map();
    return true;
  }
  return false;
}

void SlamLoop::end() noexcept {
  if (outlets_.map.copied() != pipeline_.slam().revision()) {
    while (!outlets_.map.claim()) {
      std::this_thread::yield();  // somebody reads an older one
    }
    outlets_.map.post(pipeline_.slam());
  }
}

/// False while others read the room that the order may take.
bool SlamLoop::carry_out(const SlamOrder& order) noexcept {
  if (!outlets_.map.claim()) {
    return false;
  }
  const core::MapCheck check =
      pipeline_.carry_out(order.kind, order.state, order.frozen, outlets_.map.room());
  outlets_.map.post(pipeline_.slam());
  post_status();
  orders_.done({check, pipeline_.slam().revision(), status_.scans});
  return true;
}

void SlamLoop::take(const HeadEvent& event, const SlamClock& clock) noexcept {
  if (std::holds_alternative<Scanline>(event)) {
    ++lines_;
  }
  SlamClock lent = clock;
  const hal::Stamp begun = clock.monotonic(nullptr);
  const auto fix = pipeline_.take(event, clock.utc_ahead, {search_time, &lent, begun + deadline_});
  const auto* const scan = std::get_if<ScanEnded>(&event);
  const bool is_cut = fix && is_stopping(clock) && fix->search_end == core::SearchEnd::Deadline;
  if (fix && !is_cut) {  // a search that the end of the daemon has cut has no result
    const hal::Stamp now = clock.monotonic(nullptr);
    status_.process_last = now - begun;
    status_.process_max = std::max(status_.process_max, status_.process_last);
    answer(*fix, *scan, now);
  } else if (const auto* const aborted = std::get_if<ScanAborted>(&event)) {
    void_fix(*aborted, clock);
  }
  if (!std::holds_alternative<Scanline>(event)) {
    lines_ = 0;
  }
}

void SlamLoop::answer(const core::Fix& fix, const ScanEnded& scan, hal::Stamp now) noexcept {
  counters_.count(SlamEvent::ScansLocalised);
  counters_.count(SlamEvent::ScanlinesLacking, scan.lines - std::min(lines_, scan.lines));
  const auto landmarks = pipeline_.slam().scan_landmarks();
  message_.landmark_count =
      static_cast<std::uint32_t>(std::min<std::size_t>(landmarks.size(), message_.landmarks.size()));
  std::copy_n(landmarks.begin(), message_.landmark_count, message_.landmarks.begin());
  message_.rivals = rivals_of(pipeline_.slam(), fix, acceptance_);
  message_.scan_ended = scan.known;
  ++status_.scans;
  status_.fixes += fix.status == core::FixStatus::Fix ? 1 : 0;
  send(fix, now);
  outlets_.map.set_revision(pipeline_.slam().revision());
  post_map();
  post_status();
}

/// Where the carrier moved, or what was seen cannot be relied on, the last fix is void.
void SlamLoop::void_fix(const ScanAborted& scan, const SlamClock& clock) noexcept {
  counters_.count(SlamEvent::ScansGivenUp);
  const bool is_moved = scan.reason == ScanAbort::CarrierMoved;
  if (is_moved || scan.reason == ScanAbort::TimingInDoubt) {
    const hal::Stamp now = clock.monotonic(nullptr);
    core::Fix fix;
    fix.reason = is_moved ? core::FixReason::Moved : core::FixReason::Timing;
    fix.scan = status_.scans;
    fix.time = {now + clock.utc_ahead, now + clock.utc_ahead, now + clock.utc_ahead, now};
    message_.landmark_count = 0;
    message_.rivals.clear();
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
  if (outlets_.map.is_asked() && outlets_.map.claim()) {
    outlets_.map.post(pipeline_.slam());
  }
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
  const std::array<hal::Counter, 6> more = {{{"landmarks_cut", events.landmarks_cut},
                                             {"landmarks_refused", events.landmarks_refused},
                                             {"neighbours_dropped", events.neighbours_dropped},
                                             {"searches_cut", events.searches_cut},
                                             {"cells_dropped", slam.detector().cells_dropped()},
                                             {"readings_refused", slam.detector().readings_refused()}}};
  status_.counters.append(more);
  outlets_.status.draft() = status_;
  outlets_.status.post();
}

}  // namespace slamsensor::firmware
