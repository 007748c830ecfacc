#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace slamsensor::firmware {

/// The newest value of T, handed from one writing thread to one reading thread; neither ever waits, and a
/// value is never seen half written. Values in between are lost. Three T, taken at construction.
template <typename T>
class Mailbox {
 public:
  Mailbox() = default;
  /// Three copies of `blank`.
  explicit Mailbox(const T& blank) : slots_{blank, blank, blank} {}

  /// Where the writer makes the next value; what stands there is some older one.
  [[nodiscard]] T& draft() noexcept { return slots_[writing_]; }
  /// The draft is the newest value from now on.
  void post() noexcept {
    writing_ = shared_.exchange(static_cast<std::uint8_t>(writing_ | kFresh), std::memory_order_acq_rel) &
               kIndexMask;
  }

  /// Takes the newest value; false when there was none since the last call.
  [[nodiscard]] bool refresh() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & kFresh) == 0) {
      return false;
    }
    reading_ = shared_.exchange(reading_, std::memory_order_acq_rel) & kIndexMask;
    return true;
  }
  /// The value that was taken last; the blank one before the first.
  [[nodiscard]] const T& value() const noexcept { return slots_[reading_]; }

 private:
  static constexpr std::uint8_t kIndexMask = 3;
  static constexpr std::uint8_t kFresh = 4;

  std::array<T, 3> slots_{};
  std::uint8_t writing_ = 0;
  std::atomic<std::uint8_t> shared_{1};
  std::uint8_t reading_ = 2;
};

}  // namespace slamsensor::firmware
