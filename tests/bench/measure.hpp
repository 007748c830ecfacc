#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace slamsensor::bench {

/// CPU time of the process so far, all its threads together, ms. Other programs on the machine do not count.
[[nodiscard]] double cpu_now_ms() noexcept;

/// Page faults of the process so far, with and without a disk access.
[[nodiscard]] std::uint64_t page_faults_now() noexcept;

/// CPU time (ms) of `work()`.
template <typename Work>
double cpu_of_ms(Work&& work) {
  const double start_ms = cpu_now_ms();
  std::forward<Work>(work)();
  return cpu_now_ms() - start_ms;
}

/// Times of repeated work. Room for `count_max` is taken at once: adding one does not allocate.
class Times {
 public:
  explicit Times(std::size_t count_max) { sorted_ms_.reserve(count_max); }

  /// Takes in a time; beyond count_max it is refused and stops the program.
  void add(double ms) noexcept;

  [[nodiscard]] std::size_t count() const noexcept { return sorted_ms_.size(); }
  [[nodiscard]] double mean_ms() const noexcept;
  /// The smallest time that at least `share` of all times do not exceed; 0 when there are none.
  [[nodiscard]] double quantile_ms(double share) const;
  [[nodiscard]] double worst_ms() const { return quantile_ms(1.0); }

 private:
  mutable std::vector<double> sorted_ms_;  // sorted when asked
};

}  // namespace slamsensor::bench
