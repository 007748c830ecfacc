#pragma once

#include "tools/emulator/rangefinder/lwnx_product.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::tools {

/// The settings of a LightWare device: what they are now, and what they will be after the next start.
class LwnxRegisters {
 public:
  /// The factory's values of `product`, which outlives this.
  explicit LwnxRegisters(const LwnxProduct& product);

  /// The bytes that a read of `id` returns; empty when it cannot be read.
  [[nodiscard]] std::span<const std::uint8_t> bytes(std::uint8_t id) const;

  /// The same as a number; 0 for a command the product does not have.
  [[nodiscard]] std::uint64_t value(std::uint8_t id) const;

  /// The same as a signed number of four bytes.
  [[nodiscard]] std::int32_t signed_value(std::uint8_t id) const;

  void set(std::uint8_t id, std::span<const std::uint8_t> bytes);
  void set(std::uint8_t id, std::uint64_t value);

  /// `text` cut to the width of `id`, zeros behind it.
  void set_text(std::uint8_t id, std::string_view text);

  /// Keeps the values that the product keeps.
  void save();

  /// `id` alone is kept as it is.
  void save(std::uint8_t id);

  /// The values after a start: the saved ones, the factory's where nothing is kept.
  void restore() { now_ = saved_; }

  /// The present values are the factory's: for a device that was set up before it was switched on.
  void save_all() { saved_ = now_; }

 private:
  using Values = std::array<std::vector<std::uint8_t>, 256>;

  const LwnxProduct& product_;
  Values now_;
  Values saved_;
};

}  // namespace slamsensor::tools
