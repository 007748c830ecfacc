#include "hal/pantilt/ptu_rest.hpp"

namespace slamsensor::hal {
namespace {

constexpr int kSameAnswers = 2 * 3;  // three rounds of two axes

}  // namespace

void PtuRest::restart() noexcept {
  next_ = Axis::Pan;
  rounds_ = 0;
}

void PtuRest::answer(std::int32_t position) noexcept {
  std::int32_t& before = positions_[static_cast<std::size_t>(next_)];
  rounds_ = position == before ? rounds_ + 1 : 0;
  before = position;
  next_ = next_ == Axis::Pan ? Axis::Tilt : Axis::Pan;
}

bool PtuRest::resting() const noexcept {
  return rounds_ >= kSameAnswers && next_ == Axis::Pan;
}

}  // namespace slamsensor::hal
