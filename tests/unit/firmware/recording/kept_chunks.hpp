#pragma once

#include "firmware/recording/tape_format.hpp"

#include <vector>

namespace slamsensor::tests {

/// Keeps the chunks of a tape, as long as it has room.
class KeptChunks final : public firmware::TapeSink {
 public:
  bool take(const firmware::TapeChunk& chunk) noexcept override {
    if (has_room) {
      chunks.push_back(chunk);
    }
    return has_room;
  }
  [[nodiscard]] std::vector<std::uint8_t> bytes(std::size_t i) const {
    return {chunks.at(i).bytes().begin(), chunks.at(i).bytes().end()};
  }

  std::vector<firmware::TapeChunk> chunks;
  bool has_room = true;
};

}  // namespace slamsensor::tests
