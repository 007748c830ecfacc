#pragma once

#include "firmware/config/daemon_config.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "firmware/serving/tcp_client.hpp"
#include "firmware/serving/tcp_listener.hpp"
#include "hal/counters.hpp"
#include "hal/init_error.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace slamsensor::firmware {

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
  hal::Counters<NmeaTcpEvent, kNmeaTcpEvents> counters_;
};

}  // namespace slamsensor::firmware
