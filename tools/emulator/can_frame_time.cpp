#include "tools/emulator/can_frame_time.hpp"

namespace slamsensor::tools {
namespace {

// Checksum delimiter, acknowledge slot and delimiter, end of frame (7), intermission (3): never stuffed.
constexpr std::size_t kTailBits = 13;
constexpr std::uint32_t kBaseMask = 0x7FF;
constexpr std::uint32_t kExtensionBits = 18;
constexpr std::uint32_t kExtensionMask = 0x3FFFF;

/// Counts the bits that are put on the bus, and keeps the CRC-15 (polynomial 0x4599) of those before
/// stuffing.
class BitCounter {
 public:
  void put(std::uint32_t value, unsigned bits) {
    while (bits-- > 0) {
      put_bit((value >> bits) & 1U);
    }
  }
  void put_checksum() { put(crc_, 15); }
  [[nodiscard]] std::size_t bits() const { return bits_; }

 private:
  void put_bit(std::uint32_t bit) {
    const std::uint32_t feedback = bit ^ (crc_ >> 14U);
    crc_ = ((crc_ << 1U) & 0x7FFFU) ^ (feedback != 0 ? 0x4599U : 0U);
    equal_ = bit == last_ ? equal_ + 1 : 1;
    last_ = bit;
    ++bits_;
    if (equal_ == 5) {
      ++bits_;
      last_ ^= 1U;
      equal_ = 1;
    }
  }

  std::uint32_t crc_ = 0;
  std::uint32_t last_ = 2;  // neither
  unsigned equal_ = 0;
  std::size_t bits_ = 0;
};

}  // namespace

std::size_t can_frame_bits(const hal::CanFrame& frame) {
  BitCounter counter;
  counter.put(0, 1);  // start of frame
  if (frame.extended) {
    counter.put(frame.id >> kExtensionBits, 11);
    counter.put(3, 2);  // substitute remote request, identifier extension
    counter.put(frame.id, kExtensionBits);
    counter.put(0, 3);  // remote request, two reserved
  } else {
    counter.put(frame.id, 11);
    counter.put(0, 3);  // remote request, identifier extension, reserved
  }
  counter.put(static_cast<std::uint32_t>(frame.bytes().size()), 4);
  for (const std::uint8_t byte : frame.bytes()) {
    counter.put(byte, 8);
  }
  counter.put_checksum();
  return counter.bits() + kTailBits;
}

hal::Stamp can_frame_time(const hal::CanFrame& frame, std::uint32_t bitrate) {
  return hal::Stamp(static_cast<hal::Stamp::rep>(can_frame_bits(frame)) * 1'000'000'000 /
                    static_cast<hal::Stamp::rep>(bitrate));
}

std::uint32_t arbitration_key(const hal::CanFrame& frame) noexcept {
  const std::uint32_t base = frame.extended ? frame.id >> kExtensionBits : frame.id;
  const std::uint32_t tail = frame.extended ? (1U << kExtensionBits) | (frame.id & kExtensionMask) : 0;
  return ((base & kBaseMask) << (kExtensionBits + 1)) | tail;
}

}  // namespace slamsensor::tools
