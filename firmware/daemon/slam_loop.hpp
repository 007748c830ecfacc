#pragma once

#include "core/fix.hpp"
#include "core/limits.hpp"
#include "core/mapping/map_state.hpp"
#include "core/reading.hpp"
#include "firmware/config/sensor_config.hpp"
#include "firmware/daemon/handover.hpp"
#include "firmware/pipeline.hpp"
#include "firmware/recording/event_log.hpp"
#include "firmware/status/sensor_status.hpp"
#include "firmware/store/map_snapshot.hpp"
#include "hal/counters.hpp"
#include "hal/stamp.hpp"

#include <boost/lockfree/spsc_queue.hpp>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

namespace slamsensor::firmware {

/// What the SLAM thread is asked to do with its maps, between two scans.
struct SlamOrder {
  MapCommand kind = MapCommand::Reset;
  core::MapState state;  ///< of a Restore; what it points to stays until the order is answered
  core::Frozen frozen = core::Frozen::No;  ///< with Restore: freeze too; else the mode stays as it is
};

/// What came of an order.
struct SlamAnswer {
  core::MapCheck check;        ///< of a Restore: a flaw, and then nothing was changed
  std::uint64_t revision = 0;  ///< of the map afterwards
  std::uint32_t scans = 0;     ///< localised before it, since start
};

/// One order at a time from the supervisor to the SLAM thread; neither waits.
class SlamOrders {
 public:
  /// Supervisor: false, and nothing happens, while an order is not answered.
  [[nodiscard]] bool give(const SlamOrder& order) noexcept {
    if (phase_.load(std::memory_order_acquire) != Phase::Free) {
      return false;
    }
    order_ = order;
    phase_.store(Phase::Given, std::memory_order_release);
    return true;
  }
  /// Supervisor: the answer to the last order, once.
  [[nodiscard]] std::optional<SlamAnswer> answer() noexcept {
    if (phase_.load(std::memory_order_acquire) != Phase::Answered) {
      return std::nullopt;
    }
    const SlamAnswer answer = answer_;
    phase_.store(Phase::Free, std::memory_order_release);
    return answer;
  }

  /// SLAM thread: the order to be carried out now, if any.
  [[nodiscard]] const SlamOrder* order() const noexcept {
    return phase_.load(std::memory_order_acquire) == Phase::Given ? &order_ : nullptr;
  }
  /// SLAM thread: it is carried out.
  void done(const SlamAnswer& answer) noexcept {
    answer_ = answer;
    phase_.store(Phase::Answered, std::memory_order_release);
  }

 private:
  enum class Phase : std::uint8_t { Free, Given, Answered };

  std::atomic<Phase> phase_{Phase::Free};
  SlamOrder order_;
  SlamAnswer answer_;
};

/// What the SLAM thread made of a scan.
struct FixMessage {
  core::Fix fix;
  hal::Stamp scan_ended{};  ///< when the scan thread came to know of the end of the scan
  hal::Stamp made{};
  std::uint32_t landmark_count = 0;
  std::array<core::ScanLandmark, core::kScanLandmarksMax> landmarks;  ///< seen in it, heaviest first
  RivalPlaces rivals;  ///< of an ambiguous fix, the likeliest first; those beyond kRivalsMax are left out

  [[nodiscard]] std::span<const core::ScanLandmark> seen() const noexcept {
    return {landmarks.data(), landmark_count};
  }
};

/// The home map from the SLAM thread, which never waits, to those who save and send it. A copy takes time in
/// proportion to the map, so that it is made when somebody asks for it, between two scans. There is room for
/// one.
class MapOutlet {
 public:
  explicit MapOutlet(const core::Capacities& capacities) : map_(capacities) {}

  /// Of the map that the SLAM thread has; any thread.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_.load(std::memory_order_acquire); }
  /// Of the copy that is there; any thread.
  [[nodiscard]] std::uint64_t copied() const noexcept { return copied_.load(std::memory_order_acquire); }

  /// SLAM thread: the map is another one from now on.
  void set_revision(std::uint64_t revision) noexcept { revision_.store(revision, std::memory_order_release); }
  /// SLAM thread: whether somebody waits for a copy.
  [[nodiscard]] bool is_asked() const noexcept {
    return phase_.load(std::memory_order_acquire) == Phase::Asked;
  }
  /// SLAM thread: the room is its own until `post`; false while others read it.
  [[nodiscard]] bool claim() noexcept {
    return turn(Phase::Asked, Phase::Slam) || turn(Phase::Free, Phase::Slam);
  }
  [[nodiscard]] MapSnapshot& room() noexcept { return map_; }
  /// SLAM thread, after `claim`: a copy of the home map is what others read from now on.
  void post(const core::Slam& slam) noexcept;

  /// Any other thread: a newer copy is to be made, if there is one.
  void ask() noexcept;
  /// Any other thread: calls `use(const MapSnapshot&)` with the copy that is there; false, without a call,
  /// while another one has it.
  template <typename Use>
  [[nodiscard]] bool try_read(const Use& use) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || !turn(Phase::Free, Phase::Readers)) {
      return false;
    }
    use(map_);
    phase_.store(Phase::Free, std::memory_order_release);
    return true;
  }
  /// Any other thread that may wait: calls `use(const MapSnapshot&)` with the newest map, or with an older
  /// one when the SLAM thread does not answer within kPatience.
  template <typename Use>
  auto read(const Use& use) {
    const std::scoped_lock lock(mutex_);
    wait_for_newest();
    const Reading reading(phase_);
    return use(std::as_const(map_));
  }

 private:
  enum class Phase : std::uint8_t { Free, Asked, Slam, Readers };
  static constexpr std::chrono::milliseconds kPatience{2'000};

  /// Gives the room back.
  class Reading {
   public:
    explicit Reading(std::atomic<Phase>& phase) : phase_(phase) {}
    ~Reading() { phase_.store(Phase::Free, std::memory_order_release); }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

   private:
    std::atomic<Phase>& phase_;
  };

  [[nodiscard]] bool turn(Phase from, Phase to) noexcept {
    return phase_.compare_exchange_strong(from, to, std::memory_order_acq_rel);
  }
  void wait_for_newest();

  std::mutex mutex_;  // between the readers
  std::atomic<Phase> phase_{Phase::Free};
  std::atomic<std::uint64_t> revision_{0};
  std::atomic<std::uint64_t> copied_{0};
  MapSnapshot map_;
};

/// Where the SLAM thread puts what others read. Fixes and status are the publish thread's alone.
struct SlamOutlets {
  explicit SlamOutlets(const core::Capacities& capacities) : map(capacities) {}

  boost::lockfree::spsc_queue<FixMessage> fixes{8};
  Mailbox<SlamStatus> status;
  MapOutlet map;
};

/// Clocks that the SLAM thread is lent. `monotonic` is asked during a search; `utc_ahead` is by how much UTC
/// is ahead of it now. A search ends at once when `is_stopping` is set.
struct SlamClock {
  core::Deadline::Clock monotonic = nullptr;
  hal::Stamp utc_ahead{};
  const std::atomic<bool>* is_stopping = nullptr;
};

enum class SlamEvent : std::uint8_t {
  ScansLocalised,
  ScansGivenUp,
  FixesDropped,     ///< nobody took them
  ScanlinesLacking  ///< of localised scans: dropped on the way because SLAM was busy
};

/// From scanlines to fixes: the body of the SLAM thread. No allocation after construction, no lock, no clock
/// of its own; one thread.
class SlamLoop {
 public:
  /// The others outlive this.
  SlamLoop(const Config& config, ScanQueue& scans, SlamOrders& orders, SlamOutlets& outlets);

  /// Carries out an order, folds in the next message of the queue, or copies the map for those who asked for
  /// it; false when there was nothing to do.
  [[nodiscard]] bool step(const SlamClock& clock) noexcept;

  /// After the last step: the map as it stands is there for those who save it.
  void end() noexcept;

  [[nodiscard]] const core::Slam& slam() const noexcept { return pipeline_.slam(); }

 private:
  [[nodiscard]] bool carry_out(const SlamOrder& order) noexcept;
  void take(const HeadEvent& event, const SlamClock& clock) noexcept;
  void answer(const core::Fix& fix, const ScanEnded& scan, hal::Stamp now) noexcept;
  void void_fix(const ScanAborted& scan, const SlamClock& clock) noexcept;
  void send(const core::Fix& fix, hal::Stamp now) noexcept;
  void post_map() noexcept;
  void post_status() noexcept;

  hal::Stamp deadline_;
  core::AcceptanceConfig acceptance_;
  Pipeline pipeline_;
  ScanQueue& scans_;
  SlamOrders& orders_;
  SlamOutlets& outlets_;
  FixMessage message_;  // in the making
  SlamStatus status_;
  std::uint32_t lines_ = 0;  // of the scan under way
  hal::EventCounters<SlamEvent, 4> counters_;
};

}  // namespace slamsensor::firmware
