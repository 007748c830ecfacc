#include "tools/emulator/uart_sampler.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

using hal::Stamp;

constexpr int kBits = 10;  // of a character
constexpr double kToleratedMismatch = 0.03;

Stamp half_bits(int count, std::uint32_t baud) noexcept {
  return Stamp(static_cast<Stamp::rep>(count) * 500'000'000 / static_cast<Stamp::rep>(baud));
}

bool is_high(std::uint8_t value, int bit) noexcept {
  return bit < 0 || bit == kBits - 1 || (bit > 0 && ((value >> (bit - 1)) & 1) != 0);
}

bool is_high_at(const std::deque<LineByte>& line, Stamp time) noexcept {
  const auto after = std::upper_bound(line.begin(), line.end(), time,
                                      [](Stamp t, const LineByte& b) { return t < b.begin; });
  if (after == line.begin()) {
    return true;
  }
  const LineByte& byte = *std::prev(after);
  if (time >= byte.end) {
    return true;
  }
  const auto bit = (time - byte.begin).count() * static_cast<Stamp::rep>(byte.baud) / 1'000'000'000;
  return is_high(byte.value, static_cast<int>(bit));
}

std::optional<Stamp> falling_edge(const LineByte& byte, Stamp from) noexcept {
  for (int bit = 0; bit < kBits && byte.end > from; ++bit) {
    const Stamp edge = byte.begin + half_bits(2 * bit, byte.baud);
    if (edge >= from && !is_high(byte.value, bit) && is_high(byte.value, bit - 1)) {
      return edge;
    }
  }
  return std::nullopt;
}

std::optional<Stamp> falling_edge(const std::deque<LineByte>& line, Stamp from) noexcept {
  const auto ends_later = [](Stamp t, const LineByte& b) { return t < b.end; };
  for (auto byte = std::upper_bound(line.begin(), line.end(), from, ends_later); byte != line.end(); ++byte) {
    if (const std::optional<Stamp> edge = falling_edge(*byte, from)) {
      return edge;
    }
  }
  return std::nullopt;
}

/// Where the receiver looks for the start bit itself.
Stamp start_middle(Stamp edge, std::uint32_t baud) noexcept {
  return edge + half_bits(1, baud);
}

Stamp after_glitch(Stamp edge, std::uint32_t baud) noexcept {
  return std::max(start_middle(edge, baud), edge + Stamp(1));
}

WireByte sampled(const std::deque<LineByte>& line, Stamp edge, std::uint32_t baud) noexcept {
  unsigned value = 0;
  for (int bit = 1; bit < kBits - 1; ++bit) {
    const bool high = is_high_at(line, edge + half_bits(2 * bit + 1, baud));
    value |= high ? 1U << static_cast<unsigned>(bit - 1) : 0U;
  }
  const Stamp stop = edge + half_bits(2 * kBits - 1, baud);
  return {is_high_at(line, stop) ? static_cast<std::uint8_t>(value) : std::uint8_t{0}, stop};
}

}  // namespace

bool rates_agree(std::uint32_t sender_baud, std::uint32_t receiver_baud) noexcept {
  const double sender = sender_baud;
  return std::abs(sender - static_cast<double>(receiver_baud)) <= kToleratedMismatch * sender;
}

bool has_falling_edge(const LineByte& byte, Stamp from) noexcept {
  return falling_edge(byte, from).has_value();
}

Stamp skip_glitches(const std::deque<LineByte>& line, Stamp from, Stamp now, std::uint32_t baud) {
  while (const std::optional<Stamp> edge = falling_edge(line, from)) {
    const Stamp middle = start_middle(*edge, baud);
    if (middle > now || !is_high_at(line, middle)) {
      break;
    }
    from = after_glitch(*edge, baud);
  }
  return from;
}

std::optional<WireByte> sample_character(const std::deque<LineByte>& line, Stamp from, std::uint32_t baud) {
  while (const std::optional<Stamp> edge = falling_edge(line, from)) {
    if (!is_high_at(line, start_middle(*edge, baud))) {
      return sampled(line, *edge, baud);
    }
    from = after_glitch(*edge, baud);
  }
  return std::nullopt;
}

}  // namespace slamsensor::tools
