#include "tools/emulator/lateness.hpp"

#include "tools/output/number_text.hpp"

#include <algorithm>

namespace slamsensor::tools {

void Lateness::count(hal::Stamp late, std::uint64_t times) noexcept {
  const double late_ms = hal::to_seconds(late) * 1e3;
  const auto bound = std::lower_bound(kBounds_ms.begin(), kBounds_ms.end(), late_ms);
  counts_[static_cast<std::size_t>(bound - kBounds_ms.begin())] += times;
  total_ += times;
  worst_ = std::max(worst_, late);
}

hal::Stamp Lateness::within(double share) const noexcept {
  const double wanted = share * static_cast<double>(total_);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < kBounds_ms.size() && total_ > 0; ++i) {
    sum += counts_[i];
    if (static_cast<double>(sum) >= wanted) {
      return hal::from_seconds(kBounds_ms[i] * 1e-3);
    }
  }
  return total_ > 0 ? hal::kNever : hal::Stamp{};
}

std::string Lateness::text() const {
  if (total_ == 0) {
    return "nothing was sent";
  }
  std::string text = "worst " + fixed_text(hal::to_seconds(worst_) * 1e3, 2) + " ms;";
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] > 0) {
      const bool beyond = i == kBounds_ms.size();
      text += beyond ? " beyond " : " up to ";
      append_shortest(text, kBounds_ms[beyond ? i - 1 : i]);
      text += " ms: ";
      append_integer(text, counts_[i]);
    }
  }
  return text;
}

}  // namespace slamsensor::tools
