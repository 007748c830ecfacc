#pragma once

#include "firmware/serving/tcp_address.hpp"
#include "hal/stamp.hpp"
#include "hal/transport/reopen.hpp"
#include "hal/transport/reopen_problem.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::firmware {

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

}  // namespace slamsensor::firmware
