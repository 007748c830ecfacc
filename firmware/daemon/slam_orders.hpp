#pragma once

#include "core/mapping/map_state.hpp"
#include "firmware/recording/map_order.hpp"

#include <atomic>
#include <cstdint>
#include <optional>

namespace slamsensor::firmware {

/// What the SLAM thread is told to do with its maps, between two scans.
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

}  // namespace slamsensor::firmware
