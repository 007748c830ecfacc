#pragma once

#include "firmware/supervision/file_descriptor.hpp"
#include "hal/init_error.hpp"

#include <tl/expected.hpp>

#include <csignal>
#include <cstdint>
#include <optional>

namespace slamsensor::firmware {

/// What a signal asks of the daemon.
enum class Order : std::uint8_t {
  Stop,     ///< SIGTERM, SIGINT
  Reload,   ///< SIGHUP
  SaveMap,  ///< SIGUSR1
};

/// The daemon's signals as something to poll. While one lives, SIGTERM, SIGINT, SIGHUP and SIGUSR1 are
/// blocked in the thread that made it and in all that this starts afterwards, and SIGPIPE and SIGXFSZ are
/// ignored.
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

  FileDescriptor descriptor_;
  sigset_t mask_before_{};
  struct sigaction pipe_before_ {};
  struct sigaction file_size_before_ {};
};

}  // namespace slamsensor::firmware
