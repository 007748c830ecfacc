#pragma once

#include <chrono>

namespace slamsensor::core {

/// When a computation has to end. Core reads no clock: the caller lends one. Without a clock it never
/// expires.
struct Deadline {
  using Clock = std::chrono::nanoseconds (*)(void* context) noexcept;

  Clock now = nullptr;
  void* context = nullptr;
  std::chrono::nanoseconds at{0};

  [[nodiscard]] bool expired() const noexcept { return now != nullptr && now(context) >= at; }
};

}  // namespace slamsensor::core
