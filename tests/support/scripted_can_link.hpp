#pragma once

#include "hal/transport/can_link.hpp"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace slamsensor::tests {

/// A data frame with a standard identifier.
[[nodiscard]] inline hal::CanFrame can_frame(std::uint32_t id, std::initializer_list<int> bytes) {
  hal::CanFrame frame{.id = id, .size = static_cast<std::uint8_t>(bytes.size())};
  std::transform(bytes.begin(), bytes.end(), frame.data.begin(),
                 [](int byte) { return static_cast<std::uint8_t>(byte); });
  return frame;
}

/// A bus on which a test plays the nodes. Asks the heap for nothing while frames are received and sent (up to
/// kRoom of each).
class ScriptedCanLink final : public hal::CanLink {
 public:
  static constexpr std::size_t kRoom = 1 << 16;

  ScriptedCanLink() {
    incoming_.reserve(kRoom);
    sent_.reserve(kRoom);
  }

  void set_now(hal::Stamp now) { now_ = now; }
  void set_up(bool up) {
    epoch_ += up && !up_ ? 1 : 0;
    up_ = up;
  }
  void set_full(bool full) { full_ = full; }

  /// `frame` has arrived.
  void deliver(const hal::CanFrame& frame) { incoming_.push_back({hal::LinkStatus::Ok, frame, now_}); }

  /// What was sent since the last call.
  [[nodiscard]] std::vector<hal::CanFrame> take_sent() {
    std::vector<hal::CanFrame> taken(sent_.begin(), sent_.end());
    sent_.clear();
    return taken;
  }

  void service(hal::Stamp) noexcept override {}
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return epoch_; }
  [[nodiscard]] bool is_up() const noexcept override { return up_; }

  [[nodiscard]] hal::CanRead receive() noexcept override {
    if (!up_) {
      return {hal::LinkStatus::Down, {}, now_};
    }
    if (taken_ == incoming_.size()) {
      incoming_.clear();
      taken_ = 0;
      return {};
    }
    return incoming_[taken_++];
  }

  [[nodiscard]] hal::LinkStatus send(const hal::CanFrame& frame) noexcept override {
    if (!up_) {
      return hal::LinkStatus::Down;
    }
    if (full_ || sent_.size() == kRoom) {
      return hal::LinkStatus::Busy;
    }
    sent_.push_back(frame);
    return hal::LinkStatus::Ok;
  }

 private:
  std::vector<hal::CanRead> incoming_;
  std::size_t taken_ = 0;
  std::vector<hal::CanFrame> sent_;
  hal::Stamp now_{};
  std::uint32_t epoch_ = 1;
  bool up_ = true;
  bool full_ = false;
};

}  // namespace slamsensor::tests
