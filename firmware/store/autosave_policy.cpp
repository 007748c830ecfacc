#include "firmware/store/autosave_policy.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kBackOffMin = std::chrono::seconds(1);
constexpr hal::Stamp kBackOffMax = std::chrono::minutes(15);

}  // namespace

void AutosavePolicy::saved(std::uint64_t revision, hal::Stamp now) noexcept {
  saved_ = revision;
  back_off_ = hal::Stamp{};
  next_ = now + period_;
}

void AutosavePolicy::failed(hal::Stamp now) noexcept {
  const hal::Stamp wanted = back_off_ == hal::Stamp{} ? std::max(period_, kBackOffMin) : 2 * back_off_;
  back_off_ = std::min(wanted, std::max(period_, kBackOffMax));
  next_ = now + back_off_;
}

void AutosavePolicy::set_period(hal::Stamp period) noexcept {
  if (back_off_ == hal::Stamp{}) {
    next_ += period - period_;
  }
  period_ = period;
}

}  // namespace slamsensor::firmware
