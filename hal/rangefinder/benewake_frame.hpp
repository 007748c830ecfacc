#pragma once

#include "hal/rangefinder/range_driver.hpp"
#include "hal/rangefinder/rangefinder.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::hal {

enum class BenewakeModel : std::uint8_t { Tf03, TfMini, TfMiniPlus, TfMiniS, Tf02 };

enum class BenewakeCommands : std::uint8_t {
  None,       ///< the device sends and does not listen (or listens to another protocol)
  Rate,       ///< version, format, rate, baud, output
  OverRange,  ///< those and the over-range value
};

/// What a distance word means when it is no distance.
struct RangeCode {
  std::uint16_t word = 0;
  Echo echo = Echo::None;
};

/// What differs between the devices that send Benewake's 9-byte frame (manuals of TF03, TFmini, TFmini Plus,
/// TFmini-S, TF02).
struct BenewakeProduct {
  std::string_view name;
  BenewakeCommands commands = BenewakeCommands::Rate;
  double rate_max_hz = 1000.0;
  double weak_below = 0.0;  ///< strength
  std::span<const RangeCode> codes{};
  bool has_reliability = false;  ///< byte 6 is 7 or 8 for a distance to be trusted
};

[[nodiscard]] const BenewakeProduct& benewake_product(BenewakeModel model) noexcept;

/// The fields of a reading, on whichever line it came.
struct BenewakeReading {
  std::uint16_t distance_cm = 0;
  std::uint16_t strength = 0;
  std::uint8_t reliability = 0;
};

/// A reading as a measurement: codes and `over_range_cm` (0: none) separated from distances, then judged().
[[nodiscard]] Measurement measured(const BenewakeReading& reading, const BenewakeProduct& product,
                                   std::uint16_t over_range_cm) noexcept;

/// Benewake's serial framing (TF03 manual). Data: 59 59, distance, strength, two more bytes, checksum.
/// Commands and their replies: 5A, whole length, number, payload, checksum. A checksum is the low byte of the
/// sum of all before it.
inline constexpr std::uint8_t kBenewakeData = 0x59;
inline constexpr std::uint8_t kBenewakeCommand = 0x5A;
inline constexpr std::size_t kBenewakeFrame = 9;
inline constexpr std::size_t kBenewakeCommandMin = 4;
inline constexpr std::size_t kBenewakeCommandMax = 16;

[[nodiscard]] std::uint8_t benewake_checksum(std::span<const std::uint8_t> bytes) noexcept;

/// Writes the command into `into`; its size, or 0 when it has no room there or is too long.
[[nodiscard]] std::size_t write_benewake(std::uint8_t id, std::span<const std::uint8_t> payload,
                                         std::span<std::uint8_t> into) noexcept;

/// Whether `bytes` are one whole command frame.
[[nodiscard]] bool is_benewake_command(std::span<const std::uint8_t> bytes) noexcept;

/// The reading in the data of a CAN frame (TF03 manual): distance, strength, and where there are more bytes
/// the one that follows; nothing when it is too short.
[[nodiscard]] std::optional<BenewakeReading> read_benewake_can(std::span<const std::uint8_t> data) noexcept;

/// The reply that the data of a CAN frame begin with, without the padding behind it; empty when they do not.
[[nodiscard]] std::span<const std::uint8_t> benewake_reply_in(std::span<const std::uint8_t> data) noexcept;

/// Finds data frames and replies in a stream of bytes. The checksum is weak: of nine bytes that a lost or
/// doubled one has shifted, one in 256 passes. So a frame counts only when the next frame or reply begins
/// right behind it, and after any loss only when two fit end to end at one place and no other.
class BenewakeParser {
 public:
  struct Found {
    bool has_reading = false;
    bool has_reply = false;
  };

  explicit BenewakeParser(RangeCounters& counters) noexcept : counters_(counters) {}

  /// Takes the next byte of the stream.
  [[nodiscard]] Found push(std::uint8_t byte) noexcept;

  /// No byte has come for longer than a frame of the device can be torn apart: a whole frame that only waits
  /// for what follows is found now.
  [[nodiscard]] Found pause() noexcept;

  /// Of the last push or pause that found a reading: it, and the place in the stream after it.
  [[nodiscard]] const BenewakeReading& reading() const noexcept { return reading_; }
  [[nodiscard]] std::uint64_t reading_end() const noexcept { return reading_end_; }
  /// Of the last push that found a reply: the whole frame.
  [[nodiscard]] std::span<const std::uint8_t> reply() const noexcept {
    return {tail_.data() + tail_.size() - reply_size_, reply_size_};
  }

 private:
  enum class Successor : std::uint8_t { Awaited, Fits, Foreign };

  [[nodiscard]] bool is_frame_at(std::size_t at) const noexcept;
  [[nodiscard]] Successor successor(std::size_t at) const noexcept;
  [[nodiscard]] bool is_ambiguous() const noexcept;
  [[nodiscard]] bool follow() noexcept;
  [[nodiscard]] bool follow_frame() noexcept;
  void follow_reply() noexcept;
  [[nodiscard]] bool search() noexcept;
  [[nodiscard]] bool find_reply() noexcept;
  void take_frame(std::size_t at) noexcept;
  void drop(std::size_t count) noexcept;
  void skip_byte() noexcept;
  void lose() noexcept;

  RangeCounters& counters_;
  /// Two frames, and what shows whether two fit at another place as well.
  static constexpr std::size_t kSearch = 3 * kBenewakeFrame - 1;
  std::array<std::uint8_t, kSearch> bytes_{};
  std::size_t size_ = 0;
  std::array<std::uint8_t, kBenewakeCommandMax> tail_{};  ///< the newest bytes, newest last
  std::size_t reply_size_ = 0;
  BenewakeReading reading_;
  std::uint64_t reading_end_ = 0;
  std::uint64_t position_ = 0;
  bool is_locked_ = false;
};

}  // namespace slamsensor::hal
