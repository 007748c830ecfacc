#pragma once

#include "hal/transport/byte_link.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tests {

/// A line to a device that a test plays: bytes arrive when the test said they would, at the time the test
/// says it is. Asks the heap for nothing while bytes are read and written (up to kRoom of each).
class ScriptedLink final : public hal::ByteLink {
 public:
  static constexpr std::size_t kRoom = 1 << 18;

  struct Written {
    std::string text;
    hal::Stamp at{};
    std::uint32_t baud = 0;
  };

  ScriptedLink() {
    incoming_.reserve(kRoom);
    outgoing_.reserve(kRoom);
    writes_.reserve(kRoom);
  }

  void set_now(hal::Stamp now) { now_ = now; }
  [[nodiscard]] hal::Stamp now() const { return now_; }

  void set_up(bool up) {
    epoch_ += up && !up_ ? 1 : 0;
    up_ = up;
  }

  /// Rates the hardware refuses.
  void refuse_baud(std::uint32_t baud) { refused_ = baud; }
  void set_full(bool full) { full_ = full; }

  /// `text` arrives byte by byte at `baud`, its first byte complete one byte time after `begin`.
  void deliver(std::string_view text, hal::Stamp begin, std::uint32_t baud) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      incoming_.push_back({begin + hal::line_time(i + 1, baud), static_cast<std::uint8_t>(text[i])});
    }
    std::stable_sort(incoming_.begin() + static_cast<std::ptrdiff_t>(taken_), incoming_.end(),
                     [](const Byte& a, const Byte& b) { return a.at < b.at; });
  }

  /// What was written since the last call.
  [[nodiscard]] std::vector<Written> take_writes() {
    std::vector<Written> taken;
    for (const Write& write : writes_) {
      taken.push_back({outgoing_.substr(write.offset, write.size), write.at, write.baud});
    }
    writes_.clear();
    outgoing_.clear();
    return taken;
  }

  void service(hal::Stamp) noexcept override {}
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return epoch_; }
  [[nodiscard]] bool is_up() const noexcept override { return up_; }

  [[nodiscard]] hal::ByteRead read(std::span<std::uint8_t> into) noexcept override {
    if (!up_) {
      return {hal::LinkStatus::Down, 0, now_};
    }
    std::size_t count = 0;
    while (count < into.size() && taken_ < incoming_.size() && incoming_[taken_].at <= now_) {
      into[count++] = incoming_[taken_++].value;
    }
    return {count > 0 ? hal::LinkStatus::Ok : hal::LinkStatus::Busy, count, now_};
  }

  [[nodiscard]] hal::LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override {
    if (!up_) {
      return hal::LinkStatus::Down;
    }
    if (full_) {
      return hal::LinkStatus::Busy;
    }
    writes_.push_back({outgoing_.size(), bytes.size(), now_, baud_});
    outgoing_.append(bytes.begin(), bytes.end());
    return hal::LinkStatus::Ok;
  }

  hal::LinkStatus set_baud(std::uint32_t baud) noexcept override {
    if (!up_ || baud == refused_) {
      return hal::LinkStatus::Down;
    }
    baud_ = baud;
    return hal::LinkStatus::Ok;
  }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return baud_; }

  void discard_input() noexcept override {
    while (taken_ < incoming_.size() && incoming_[taken_].at <= now_) {
      ++taken_;
    }
  }

 private:
  struct Byte {
    hal::Stamp at{};
    std::uint8_t value = 0;
  };
  struct Write {
    std::size_t offset = 0;
    std::size_t size = 0;
    hal::Stamp at{};
    std::uint32_t baud = 0;
  };

  std::vector<Byte> incoming_;
  std::size_t taken_ = 0;
  std::string outgoing_;
  std::vector<Write> writes_;
  hal::Stamp now_{};
  std::uint32_t baud_ = 9600;
  std::uint32_t epoch_ = 0;
  std::uint32_t refused_ = 0;
  bool up_ = false;
  bool full_ = false;
};

}  // namespace slamsensor::tests
