#pragma once

#include "firmware/output/nmea.hpp"
#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <poll.h>
#include <span>

namespace slamsensor::firmware {

/// What became of a call on a client.
enum class ClientStatus : std::uint8_t {
  Ok,
  Full,  ///< what went before has not been taken yet: the bytes are not sent
  Gone,  ///< the connection is at its end; close()
};

/// One reader at the other end of a TCP connection: sends whole epochs, throws away what it says. What the
/// network does not take at once waits in a small buffer, so that a slow reader loses epochs and not
/// freshness. Never waits, allocates nothing. One thread.
class TcpClient {
 public:
  /// Epochs that wait here, beside those in the kernel's buffer.
  static constexpr std::size_t kBufferBytes = 4 * kNmeaEpochBytesMax;

  TcpClient() = default;
  TcpClient(const TcpClient&) = delete;
  TcpClient& operator=(const TcpClient&) = delete;
  ~TcpClient() { close(); }

  /// Takes the connected, non-blocking socket `fd` over. It must not be open.
  void open(int fd, hal::Stamp now) noexcept;
  void close() noexcept;
  [[nodiscard]] bool is_open() const noexcept { return fd_ >= 0; }

  /// All of `bytes` after what went before (Ok), or none (Full, Gone). At most kBufferBytes.
  [[nodiscard]] ClientStatus send(std::span<const char> bytes, hal::Stamp now) noexcept;
  /// Sends what waits, as far as the network takes it.
  [[nodiscard]] ClientStatus flush(hal::Stamp now) noexcept;
  /// Throws away what has arrived and adds the number of bytes to `ignored`.
  [[nodiscard]] ClientStatus drain(std::uint64_t& ignored) noexcept;

  /// How long nothing has been taken of what waits; zero when nothing waits.
  [[nodiscard]] hal::Stamp stuck_for(hal::Stamp now) const noexcept;
  /// It has closed its sending side: a reader that never speaks, or one that has left.
  [[nodiscard]] bool has_hushed() const noexcept { return has_hushed_; }

  [[nodiscard]] pollfd poll_on() const noexcept;

 private:
  [[nodiscard]] std::size_t waiting() const noexcept { return end_ - begin_; }

  int fd_ = -1;
  bool has_hushed_ = false;
  hal::Stamp progress_{};  ///< when the network last took something, or nothing waited
  std::array<char, kBufferBytes> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace slamsensor::firmware
