#pragma once

#include "firmware/recording/tape_writer.hpp"
#include "tests/unit/firmware/recording/kept_chunks.hpp"
#include "tools/recording/playback.hpp"

#include <functional>
#include <vector>

namespace slamsensor::tests {

/// A tape that a test has written, chunk by chunk.
class MadeTape final : public tools::ChunkSource {
 public:
  explicit MadeTape(const std::function<void(firmware::TapeWriter&)>& write) {
    firmware::TapeWriter tape(kept_);
    write(tape);
    static_cast<void>(tape.finish());
  }

  [[nodiscard]] std::vector<firmware::TapeChunk>& chunks() { return kept_.chunks; }

  std::optional<Chunk> next() override {
    if (at_ == kept_.chunks.size()) {
      return std::nullopt;
    }
    const firmware::TapeChunk& chunk = kept_.chunks[at_++];
    return Chunk{static_cast<std::int64_t>(chunk.number), chunk.bytes()};
  }

 private:
  KeptChunks kept_;
  std::size_t at_ = 0;
};

}  // namespace slamsensor::tests
