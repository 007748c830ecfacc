#pragma once

#include "firmware/recording/tape_format.hpp"

namespace slamsensor::firmware {

/// Takes full chunks off a tape's writer, on the writer's thread.
class TapeSink {
 public:
  TapeSink() = default;
  TapeSink(const TapeSink&) = delete;
  TapeSink& operator=(const TapeSink&) = delete;
  virtual ~TapeSink() = default;

  /// Copies `chunk`; false, and nothing is kept, when there is no room. Waits for nothing.
  [[nodiscard]] virtual bool take(const TapeChunk& chunk) noexcept = 0;
};

}  // namespace slamsensor::firmware
