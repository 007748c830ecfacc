#pragma once

#include "firmware/config/daemon_config.hpp"
#include "firmware/output/nmea.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "hal/counters.hpp"
#include "hal/init_error.hpp"
#include "hal/stamp.hpp"
#include "hal/transport/reopen.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <poll.h>
#include <span>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <vector>

namespace slamsensor::firmware {

/// A numeric IPv4 or IPv6 address with a port, to listen on.
class TcpAddress {
 public:
  /// As the kernel takes it.
  struct Raw {
    sockaddr_storage storage{};
    socklen_t size = 0;
  };

  /// "127.0.0.1", "0.0.0.0", "::1", "::" or "fe80::1%eth0"; none when `address` is no such thing or `port` is
  /// not within 1 .. 65535 (0: any free port).
  [[nodiscard]] static std::optional<TcpAddress> parse(const std::string& address, std::uint32_t port);

  /// For bind(). The interface that an address names is looked up now: it may come later than the program.
  /// None while there is no such interface. Allocates nothing.
  [[nodiscard]] std::optional<Raw> raw() const noexcept;

  /// "127.0.0.1:10110", "[::1]:10110".
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  TcpAddress() = default;

  Raw raw_;
  std::string interface_;
  std::string text_;
};

/// What became of a look for a new client.
enum class AcceptStatus : std::uint8_t {
  Client,  ///< there is one
  None,    ///< nobody waits
  Gone,    ///< one waited and has left, or could not be had; there may be another
  Failed,  ///< the program or the machine has run out of something; it is tried again later
};

struct Accepted {
  AcceptStatus status = AcceptStatus::None;
  int fd = -1;  ///< of a client: non-blocking, the taker closes it
};

/// A TCP port that is listened on; when that cannot be (address in use, or not there yet), it is tried again
/// with back-off. Never waits; allocates nothing after construction. One thread.
class TcpListener {
 public:
  /// `kind` names the port in problems ("NMEA TCP port") and lives as long as the program.
  TcpListener(TcpAddress address, std::string_view kind);
  TcpListener(const TcpListener&) = delete;
  TcpListener& operator=(const TcpListener&) = delete;
  ~TcpListener();

  /// Opens the port when that is due. True when it was opened by this call.
  bool service(hal::Stamp now) noexcept;

  [[nodiscard]] Accepted accept(hal::Stamp now) noexcept;

  /// To poll() for reading; -1 while nobody can be taken in.
  [[nodiscard]] int poll_fd(hal::Stamp now) const noexcept { return now >= rest_until_ ? fd_ : -1; }

  /// The port that is listened on, which the kernel chose when that of the address is 0; 0 while it is not
  /// open.
  [[nodiscard]] std::uint16_t port() const noexcept;

  /// Attempts to open that failed.
  [[nodiscard]] std::uint64_t failures() const noexcept { return failures_; }

  /// Why it is not open and what to do; empty when it is.
  [[nodiscard]] std::string_view problem() const noexcept { return problem_.view(); }

 private:
  [[nodiscard]] std::optional<hal::OpenFailure> open() noexcept;

  TcpAddress address_;
  std::string_view kind_;
  int fd_ = -1;
  hal::Stamp rest_until_{};
  hal::ReopenTimer timer_;
  hal::ReopenProblem problem_;
  std::uint64_t failures_ = 0;
};

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

enum class NmeaTcpEvent : std::uint8_t {
  Opened,        ///< the port was opened
  OpenFailed,    ///< it could not be
  Accepted,      ///< clients
  Refused,       ///< clients beyond clients_max, closed at once
  AcceptFailed,  ///< clients that could not be had
  Left,          ///< clients that closed or were lost
  Displaced,     ///< clients that had closed their sending side and made room for another
  Stuck,         ///< clients closed because they took nothing for too long
  Epochs,        ///< handed to a client; one for each client
  Bytes,         ///< of them
  Dropped,       ///< epochs lost by a slow client; one for each client
  Ignored,       ///< bytes that clients wrote to us, such as gpsd's probes
};
inline constexpr std::size_t kNmeaTcpEvents = static_cast<std::size_t>(NmeaTcpEvent::Ignored) + 1;

/// Epochs for whoever connects to a TCP port (IANA: 10110, NMEA 0183 over IP). Clients only listen; what they
/// send is thrown away.
class NmeaTcpServer final : public EpochSink {
 public:
  /// A client that takes nothing for this long while something waits is closed.
  static constexpr hal::Stamp kStuckMax = std::chrono::seconds(30);

  /// The port is opened by step(), with back-off until it can be. The error names the setting.
  [[nodiscard]] static tl::expected<std::unique_ptr<NmeaTcpServer>, hal::InitError> create(
      const NmeaTcpConfig& config);

  void step(hal::Stamp now) noexcept override;
  void send(std::span<const char> epoch, const OutputTime& now) noexcept override;
  [[nodiscard]] std::size_t poll_on(std::span<pollfd> into) const noexcept override;
  [[nodiscard]] std::string_view problem() const noexcept override { return listener_.problem(); }
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept override { return counters_.all(); }

  /// A line for the log when clients were refused since the last line, at most one a minute; empty when there
  /// is nothing to say. Allocates.
  [[nodiscard]] std::string take_refusals(hal::Stamp now);

  [[nodiscard]] std::size_t clients() const noexcept;
  /// The port that is listened on, 0 while none is.
  [[nodiscard]] std::uint16_t port() const noexcept { return listener_.port(); }

 private:
  NmeaTcpServer(TcpAddress address, std::size_t clients_max);

  void take_in(int fd) noexcept;
  [[nodiscard]] TcpClient* free_place() noexcept;
  void look_after(TcpClient& client) noexcept;
  void let_go(TcpClient& client, NmeaTcpEvent why) noexcept;

  TcpListener listener_;
  std::vector<TcpClient> clients_;
  hal::Stamp now_{};
  hal::EventCounters<NmeaTcpEvent, kNmeaTcpEvents> counters_;
  std::uint64_t refused_ = 0;  ///< clients that no line tells of yet
  hal::Stamp refusals_due_{};
};

}  // namespace slamsensor::firmware
