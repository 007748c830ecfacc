#pragma once

#include "hal/stamp.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tools {

enum class LwnxAccess : std::uint8_t { Read, Write };

/// A request of the host that arrived whole.
struct LwnxRequest {
  std::uint8_t id = 0;
  LwnxAccess access = LwnxAccess::Read;
  std::vector<std::uint8_t> data;
};

/// The packet that carries `data` (at most 1022 bytes) under `id`, in place of what was in `packet`: start,
/// length and access, ID, data, CRC (LW20 serial manual).
void build_packet(std::uint8_t id, LwnxAccess access, std::span<const std::uint8_t> data,
                  std::vector<std::uint8_t>& packet);

/// Finds the host's requests between other bytes. A packet that stops for 100 ms is forgotten; after a wrong
/// CRC the search goes on one byte behind the false start.
class LwnxReceiver {
 public:
  /// Takes a byte that arrived at `at`; a request when it completes one.
  [[nodiscard]] std::optional<LwnxRequest> push(std::uint8_t byte, hal::Stamp at);

  /// Whether a packet has begun and is not complete.
  [[nodiscard]] bool in_packet() const { return !buffer_.empty(); }

  void clear() { buffer_.clear(); }

  /// Packets with a wrong CRC or an impossible length.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  [[nodiscard]] std::optional<LwnxRequest> take_request();
  [[nodiscard]] std::size_t packet_bytes() const;
  void skip_false_start();

  std::vector<std::uint8_t> buffer_;
  hal::Stamp last_byte_{};
  std::uint64_t refused_ = 0;
};

/// `value` in `bytes` bytes, least significant first, at the end of `data`.
void append_little_endian(std::int64_t value, std::size_t bytes, std::vector<std::uint8_t>& data);

/// All of `data` as an unsigned number, least significant byte first; at most 8 bytes.
[[nodiscard]] std::uint64_t little_endian(std::span<const std::uint8_t> data);

}  // namespace slamsensor::tools
