#include "firmware/supervision/signals.hpp"

#include <cerrno>
#include <cstring>
#include <sys/signalfd.h>

namespace slamsensor::firmware {
namespace {

constexpr int kTaken[] = {SIGTERM, SIGINT, SIGHUP, SIGUSR1};

std::optional<Order> order_of(std::uint32_t signal) noexcept {
  switch (signal) {
    case SIGTERM:
    case SIGINT:
      return Order::Stop;
    case SIGHUP:
      return Order::Reload;
    case SIGUSR1:
      return Order::SaveMap;
    default:
      return std::nullopt;
  }
}

}  // namespace

tl::expected<Signals, hal::InitError> Signals::create() {
  sigset_t taken;
  sigemptyset(&taken);
  for (const int signal : kTaken) {
    sigaddset(&taken, signal);
  }
  Signals signals;
  const int masked = ::pthread_sigmask(SIG_BLOCK, &taken, &signals.mask_before_);
  if (masked == 0) {
    struct sigaction ignored {};
    ignored.sa_handler = SIG_IGN;
    ::sigaction(SIGPIPE, &ignored, &signals.pipe_before_);
    ::sigaction(SIGXFSZ, &ignored, &signals.file_size_before_);  // a full file is an error, not the end
    signals.descriptor_ = FileDescriptor(::signalfd(-1, &taken, SFD_NONBLOCK | SFD_CLOEXEC));
  }
  if (!signals.descriptor_) {
    const int error = masked != 0 ? masked : errno;
    return tl::unexpected(hal::InitError{std::string("signals cannot be taken: ") + std::strerror(error) +
                                         "; raise the limit of open files and try again"});
  }
  return signals;
}

Signals::~Signals() {
  if (descriptor_) {
    ::sigaction(SIGPIPE, &pipe_before_, nullptr);
    ::sigaction(SIGXFSZ, &file_size_before_, nullptr);
    ::pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
  }
}

std::optional<Order> Signals::take() noexcept {
  signalfd_siginfo info{};
  const ssize_t size = ::read(descriptor_.get(), &info, sizeof info);
  return size == sizeof info ? order_of(info.ssi_signo) : std::nullopt;
}

}  // namespace slamsensor::firmware
