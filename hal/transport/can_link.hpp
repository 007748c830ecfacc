#pragma once

#include "hal/transport/byte_link.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::hal {

/// A classical CAN data frame. (Remote frames are neither sent nor handed out.)
struct CanFrame {
  std::uint32_t id = 0;  ///< 11 bits, or 29 when `extended`
  bool extended = false;
  std::uint8_t size = 0;  ///< bytes of `data` in use, at most 8; a transport never hands out more
  std::array<std::uint8_t, 8> data{};

  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept {
    return {data.data(), size <= data.size() ? size : data.size()};
  }
  friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

struct CanRead {
  LinkStatus status = LinkStatus::Busy;
  CanFrame frame;  ///< valid when the status is Ok
  Stamp stamp{};   ///< when the frame had arrived: the kernel's time where it gives one
};

/// One socket on a CAN bus. No waiting. One thread.
class CanLink {
 public:
  CanLink() = default;
  CanLink(const CanLink&) = delete;
  CanLink& operator=(const CanLink&) = delete;
  virtual ~CanLink() = default;

  /// Brings a lost link back, with back-off. Call it at every step, before receiving.
  virtual void service(Stamp now) noexcept = 0;

  /// Grows by one each time the link comes up (interface up, bus on); 0 before the first time.
  [[nodiscard]] virtual std::uint32_t epoch() const noexcept = 0;

  [[nodiscard]] virtual bool is_up() const noexcept = 0;

  /// See ByteLink::problem.
  [[nodiscard]] virtual std::string_view problem() const noexcept { return {}; }

  /// See ByteLink::counters.
  [[nodiscard]] virtual std::span<const Counter> counters() const noexcept { return {}; }

  /// Takes the oldest frame that passed the filters.
  [[nodiscard]] virtual CanRead receive() noexcept = 0;

  /// Sends `frame` (Ok) or not (Busy: no room; Down).
  [[nodiscard]] virtual LinkStatus send(const CanFrame& frame) noexcept = 0;
};

}  // namespace slamsensor::hal
