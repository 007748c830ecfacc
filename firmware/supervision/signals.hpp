#pragma once

#include "firmware/supervision/file_descriptor.hpp"
#include "hal/init_error.hpp"

#include <tl/expected.hpp>

#include <csignal>
#include <cstdint>
#include <optional>
#include <vector>

namespace slamsensor::firmware {

/// What a signal asks of the daemon.
enum class Order : std::uint8_t {
  Stop,     ///< SIGTERM, SIGINT, SIGQUIT, SIGPWR, SIGXCPU
  Reload,   ///< SIGHUP
  SaveMap,  ///< SIGUSR1
};

/// The daemon's signals as something to poll. While one lives, the signals of Order are blocked in the thread
/// that made it and in all that this starts afterwards, and every other signal that would end the process and
/// is no fault of the program is ignored: none ends the daemon without a last save.
class Signals {
 public:
  /// Before any other thread is started.
  [[nodiscard]] static tl::expected<Signals, hal::InitError> create();

  Signals(Signals&& other) noexcept = default;
  Signals& operator=(Signals&& other) = delete;
  ~Signals();

  /// Readable when there is an order.
  [[nodiscard]] int fd() const noexcept { return descriptor_.get(); }
  /// The next order; none when there is none. Never waits.
  [[nodiscard]] std::optional<Order> take() noexcept;

 private:
  Signals() = default;
  void ignore_others();

  FileDescriptor descriptor_;
  sigset_t mask_before_{};
  std::vector<struct sigaction> before_;  // of the signals that are ignored
};

}  // namespace slamsensor::firmware
