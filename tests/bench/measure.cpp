#include "tests/bench/measure.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <sys/resource.h>
#include <time.h>

namespace slamsensor::bench {

double cpu_now_ms() noexcept {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

std::uint64_t page_faults_now() noexcept {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return static_cast<std::uint64_t>(use.ru_minflt) + static_cast<std::uint64_t>(use.ru_majflt);
}

void Times::add(double ms) noexcept {
  if (sorted_ms_.size() == sorted_ms_.capacity()) {
    std::abort();
  }
  sorted_ms_.push_back(ms);
}

double Times::mean_ms() const noexcept {
  return sorted_ms_.empty() ? 0.0
                            : std::accumulate(sorted_ms_.begin(), sorted_ms_.end(), 0.0) /
                                  static_cast<double>(sorted_ms_.size());
}

double Times::quantile_ms(double share) const {
  if (sorted_ms_.empty()) {
    return 0.0;
  }
  std::sort(sorted_ms_.begin(), sorted_ms_.end());
  const double rank = std::ceil(share * static_cast<double>(sorted_ms_.size()));
  const auto index = static_cast<std::size_t>(std::max(1.0, rank)) - 1;
  return sorted_ms_[std::min(index, sorted_ms_.size() - 1)];
}

}  // namespace slamsensor::bench
