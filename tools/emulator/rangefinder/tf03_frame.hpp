#pragma once

#include "tools/emulator/rangefinder/tf03_settings.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tools {

/// What a frame tells: the words of distance and strength, whatever they stand for.
struct Tf03Words {
  std::uint16_t distance = 0;
  std::uint16_t strength = 0;
  bool is_trusted = false;  ///< the TF02 tells it in byte 6
};

/// The words for a sight, by the codes of the model; nothing when the model has no word for an error.
[[nodiscard]] Tf03Words tf03_words(const Tf03Settings& settings, const Tf03Parameters& parameters,
                                   const Sight& sight);

/// The nine bytes 59 59 .. on a UART: distance and strength, two bytes of the model, sum of the others.
void build_tf03_frame(const Tf03Settings& settings, const Tf03Words& words, std::vector<std::uint8_t>& out);

/// A line of text in metres, as format 2 has it.
void build_tf03_text(const Tf03Words& words, std::vector<std::uint8_t>& out);

/// The data of a CAN frame: distance, strength, zeros.
void build_tf03_can(const Tf03Settings& settings, const Tf03Words& words, std::vector<std::uint8_t>& out);

/// `body`, which begins with 5A and its length, with its sum behind it.
[[nodiscard]] std::vector<std::uint8_t> with_tf03_sum(std::vector<std::uint8_t> body);

/// Finds commands 5A LEN ID ... SUM between other bytes. One that stops for 100 ms is forgotten.
class Tf03Receiver {
 public:
  /// Takes a byte; the whole command when it completes one whose sum is right (or not `checked`).
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> push(std::uint8_t byte, Stamp at,
                                                              Tf03Switch checked);

  void clear() { buffer_.clear(); }

  /// Commands with a wrong sum or an impossible length.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> take(Tf03Switch checked);

  std::vector<std::uint8_t> buffer_;
  Stamp last_byte_{};
  std::uint64_t refused_ = 0;
};

}  // namespace slamsensor::tools
