#pragma once

#include "hal/transport/can_link.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::tests {

/// A bus on which a fuzzer's input plays the nodes. The input is a list of records: a byte that picks one of
/// eight identifiers and the size of a frame, then the frame's bytes.
class FuzzCanLink : public hal::CanLink {
 public:
  using Ids = std::array<std::uint32_t, 8>;

  FuzzCanLink(std::span<const std::uint8_t> input, const Ids& ids) : input_(input), ids_(ids) {}

  /// Between two of them one frame of the input arrives.
  void pass_a_millisecond() {
    now_ += std::chrono::milliseconds(1);
    is_due_ = true;
  }
  /// Nothing of the input arrives meanwhile.
  void pass_quietly() {
    now_ += std::chrono::milliseconds(1);
    is_due_ = false;
  }
  [[nodiscard]] hal::Stamp now() const { return now_; }
  [[nodiscard]] bool is_over() const { return input_.empty(); }

  void service(hal::Stamp) noexcept override {}
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return 1; }
  [[nodiscard]] bool is_up() const noexcept override { return true; }

  [[nodiscard]] hal::CanRead receive() noexcept override {
    if (!is_due_ || input_.empty()) {
      return {};
    }
    is_due_ = false;
    const std::uint8_t head = input_[0];
    hal::CanFrame frame;
    frame.id = ids_[head % ids_.size()];
    frame.extended = frame.id > 0x7FF;
    frame.size = std::min<std::uint8_t>(head >> 3, 8);  // no transport hands out more
    const std::size_t count = std::min<std::size_t>(frame.size, input_.size() - 1);
    std::copy_n(input_.begin() + 1, count, frame.data.begin());
    input_ = input_.subspan(1 + count);
    return {hal::LinkStatus::Ok, frame, now_};
  }

  [[nodiscard]] hal::LinkStatus send(const hal::CanFrame&) noexcept override { return hal::LinkStatus::Ok; }

 private:
  std::span<const std::uint8_t> input_;
  Ids ids_;
  hal::Stamp now_ = std::chrono::seconds(1);
  bool is_due_ = false;
};

}  // namespace slamsensor::tests
