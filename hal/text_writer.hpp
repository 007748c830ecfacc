#pragma once

#include "hal/fixed_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slamsensor::hal {

/// Writes words and figures side by side without memory of its own; what is beyond `kCapacity` is cut off.
template <std::size_t kCapacity>
class TextWriter {
 public:
  TextWriter& operator<<(std::string_view words) noexcept {
    const std::size_t count = std::min(words.size(), text_.size() - size_);
    std::copy_n(words.begin(), count, text_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += count;
    return *this;
  }

  /// `value` rounded, without sign.
  TextWriter& whole(double value) noexcept {
    std::array<char, 24> digits{};
    const auto rounded = std::llround(std::isfinite(value) ? std::clamp(value, 0.0, 1e15) : 0.0);
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), rounded);
    return *this << std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }

  /// `value` with one decimal, without sign.
  TextWriter& tenths(double value) noexcept {
    const double scaled = std::round(10.0 * (std::isfinite(value) ? std::clamp(value, 0.0, 1e12) : 0.0));
    const double rest = std::fmod(scaled, 10.0);
    return whole((scaled - rest) / 10.0)
           << "." << std::string_view("0123456789", 10).substr(static_cast<std::size_t>(rest), 1);
  }

  [[nodiscard]] FixedText<kCapacity> text() const noexcept {
    return FixedText<kCapacity>(std::string_view(text_.data(), size_));
  }

 private:
  std::array<char, kCapacity> text_{};
  std::size_t size_ = 0;
};

}  // namespace slamsensor::hal
