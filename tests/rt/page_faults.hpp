#pragma once

#include <cstdint>

namespace slamsensor::tests {

/// Counts the page faults of its thread, minor and major, while it lives.
class PageFaultScope {
 public:
  PageFaultScope() noexcept;

  [[nodiscard]] std::uint64_t faults() const noexcept;

 private:
  std::uint64_t before_;
};

/// Brings every page that the process has mapped into memory, and keeps it there if it may: locked, or else
/// each mapping populated once. False when neither is to be had, and faults therefore say nothing.
[[nodiscard]] bool hold_memory();

}  // namespace slamsensor::tests
