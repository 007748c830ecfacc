#pragma once

#include "hal/transport/byte_link.hpp"
#include "tools/emulator/emulated_head.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A line on which somebody sits: what he lets through of what has arrived, and when.
class TamperedLink final : public hal::ByteLink {
 public:
  bool is_stalled = false;                          // the host reads nothing
  hal::Stamp late{};                                // by which bytes come later
  std::function<int(std::uint64_t record)> copies;  // of each record of a LightWare device
  std::function<std::size_t()> noise;               // bytes of noise before each record

  TamperedLink(hal::ByteLink& link, InProcessHead& head) : link_(link), head_(head) {}

  void service(hal::Stamp now) noexcept override { link_.service(now); }
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return link_.epoch(); }
  [[nodiscard]] bool is_up() const noexcept override { return link_.is_up(); }
  [[nodiscard]] std::string_view problem() const noexcept override { return link_.problem(); }
  [[nodiscard]] hal::LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override {
    return link_.write(bytes);
  }
  hal::LinkStatus set_baud(std::uint32_t baud) noexcept override { return link_.set_baud(baud); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return link_.baud(); }
  void discard_input() noexcept override {
    link_.discard_input();
    passed_.clear();
  }

  [[nodiscard]] hal::ByteRead read(std::span<std::uint8_t> into) noexcept override {
    if (is_stalled) {
      return {};
    }
    std::array<std::uint8_t, 512> got{};
    for (hal::ByteRead bytes = link_.read(got); bytes.status == hal::LinkStatus::Ok;
         bytes = link_.read(got)) {
      for (const std::uint8_t byte : std::span(got).first(bytes.count)) {
        take(byte);
      }
    }
    hal::ByteRead out;
    while (out.count < into.size() && !passed_.empty() && passed_.front().due <= head_.now()) {
      into[out.count++] = passed_.front().byte;
      passed_.pop_front();
    }
    out.status = out.count > 0 ? hal::LinkStatus::Ok : hal::LinkStatus::Busy;
    out.stamp = head_.now();
    return out;
  }

 private:
  struct Passed {
    std::uint8_t byte;
    hal::Stamp due;
  };

  void pass(std::uint8_t byte) { passed_.push_back({byte, head_.now() + late}); }

  /// 0xAA, two bytes with the length of what follows them in their upper ten bits, that, and a CRC of two.
  void take(std::uint8_t byte) {
    if (!copies && !noise) {
      return pass(byte);
    }
    record_.push_back(byte);
    if (record_[0] != 0xAA) {
      pass(byte);
      record_.clear();
      return;
    }
    if (record_.size() < 3) {
      return;
    }
    const std::size_t length = static_cast<std::size_t>(record_[1] | record_[2] << 8) >> 6;
    if (record_.size() < 3 + length + 2) {
      return;
    }
    for (std::size_t i = noise ? noise() : 0; i > 0; --i) {
      pass(static_cast<std::uint8_t>(i * 73 + records_));
    }
    for (int copy = copies ? copies(records_) : 1; copy > 0; --copy) {
      for (const std::uint8_t part : record_) {
        pass(part);
      }
    }
    ++records_;
    record_.clear();
  }

  hal::ByteLink& link_;
  InProcessHead& head_;
  std::deque<Passed> passed_;
  std::vector<std::uint8_t> record_;
  std::uint64_t records_ = 0;
};

}  // namespace slamsensor::tools
