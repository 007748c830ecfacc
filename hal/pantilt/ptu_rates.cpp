#include "hal/pantilt/ptu_rates.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr std::uint32_t kNetworkBaud = 9600;  // units with an identity keep to it (PTU-D46 manual)

std::size_t index_of(const std::vector<std::uint32_t>& rates, std::uint32_t rate) noexcept {
  return static_cast<std::size_t>(std::find(rates.begin(), rates.end(), rate) - rates.begin());
}

}  // namespace

PtuRates::PtuRates(const PtuConfig& config) : rates_(config.rates_baud), fast_wanted_(config.fast_baud != 0) {
  fast_index_ = index_of(rates_, config.fast_baud);
  if (fast_wanted_ && fast_index_ == rates_.size()) {
    rates_.push_back(config.fast_baud);
  }
}

PtuRates::Step PtuRates::advance() noexcept {
  if (on_trial_) {
    on_trial_ = false;
    fast_refused_ = true;
    index_ = before_trial_;
    return Step::TrialFailed;
  }
  index_ = (index_ + 1) % rates_.size();
  ++tried_;
  return tried_ % rates_.size() == 0 ? Step::WentRound : Step::Next;
}

bool PtuRates::wants_fast() const noexcept {
  return fast_wanted_ && !fast_refused_ && !on_trial_ && index_ != fast_index_;
}

void PtuRates::try_fast() noexcept {
  before_trial_ = index_;
  index_ = fast_index_;
  on_trial_ = true;
}

void PtuRates::confirm() noexcept {
  tried_ = 0;
  on_trial_ = false;
}

void PtuRates::go_to_network_rate() noexcept {
  const std::size_t index = index_of(rates_, kNetworkBaud);
  index_ = index < rates_.size() ? index : index_;
}

}  // namespace slamsensor::hal
