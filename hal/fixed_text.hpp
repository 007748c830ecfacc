#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace slamsensor::hal {

/// Text of at most `kCapacity` characters, in place: what a device says of itself.
template <std::size_t kCapacity>
class FixedText {
 public:
  constexpr FixedText() noexcept = default;

  /// Takes the first `kCapacity` characters of `text`; anything but printable ASCII becomes '?'.
  constexpr explicit FixedText(std::string_view text) noexcept : size_(std::min(text.size(), kCapacity)) {
    std::transform(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(size_), text_.begin(),
                   [](char c) { return c >= ' ' && c <= '~' ? c : '?'; });
  }

  [[nodiscard]] constexpr std::string_view view() const noexcept { return {text_.data(), size_}; }

 private:
  std::array<char, kCapacity> text_{};
  std::size_t size_ = 0;
};

}  // namespace slamsensor::hal
