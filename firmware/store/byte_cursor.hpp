#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// Appends numbers to bytes, little-endian.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::uint8_t>& out) : out_(out) {}

  template <std::unsigned_integral T>
  void put(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      out_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  void put(std::int64_t value) { put(static_cast<std::uint64_t>(value)); }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  /// Its length in two bytes, then its characters; at most 65535 of them.
  void put(std::string_view text) {
    const std::string_view kept = text.substr(0, UINT16_MAX);
    put(static_cast<std::uint16_t>(kept.size()));
    out_.insert(out_.end(), kept.begin(), kept.end());
  }

 private:
  std::vector<std::uint8_t>& out_;
};

/// Takes numbers from bytes, little-endian. What lies beyond the end is zero, and `overran()` tells.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::unsigned_integral T>
  [[nodiscard]] T take() {
    const std::span<const std::uint8_t> raw = take_bytes(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      value |= std::uint64_t{raw[i]} << (8 * i);
    }
    return static_cast<T>(value);
  }
  [[nodiscard]] std::int64_t take_signed() { return static_cast<std::int64_t>(take<std::uint64_t>()); }
  [[nodiscard]] double take_double() { return std::bit_cast<double>(take<std::uint64_t>()); }
  [[nodiscard]] std::string take_text() {
    const std::span<const std::uint8_t> raw = take_bytes(take<std::uint16_t>());
    return {raw.begin(), raw.end()};
  }
  /// The next `count` bytes; none, and all is overrun, when there are not so many.
  [[nodiscard]] std::span<const std::uint8_t> take_bytes(std::size_t count) {
    if (count > bytes_.size()) {
      overran_ = true;
      bytes_ = {};
      return {};
    }
    const std::span<const std::uint8_t> taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }

  [[nodiscard]] bool overran() const { return overran_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool overran_ = false;
};

}  // namespace slamsensor::firmware
