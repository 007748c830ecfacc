#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::hal {

/// How often something happened since construction. `name` is lower_snake and lives as long as the program.
struct Counter {
  std::string_view name;
  std::uint64_t value = 0;
};

/// The counters of one driver or transport, one for each enumerator of `Event` (0, 1, 2, ...).
template <typename Event, std::size_t kCount>
class EventCounters {
 public:
  /// `names` in the order of the enumerators.
  explicit constexpr EventCounters(const std::array<std::string_view, kCount>& names) noexcept {
    for (std::size_t i = 0; i < kCount; ++i) {
      counters_[i].name = names[i];
    }
  }

  void count(Event event, std::uint64_t times = 1) noexcept {
    counters_[static_cast<std::size_t>(event)].value += times;
  }
  [[nodiscard]] std::uint64_t operator[](Event event) const noexcept {
    return counters_[static_cast<std::size_t>(event)].value;
  }
  [[nodiscard]] std::span<const Counter> all() const noexcept { return counters_; }

 private:
  std::array<Counter, kCount> counters_{};
};

}  // namespace slamsensor::hal
