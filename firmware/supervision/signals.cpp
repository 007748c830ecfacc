#include "firmware/supervision/signals.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <sys/signalfd.h>

namespace slamsensor::firmware {
namespace {

constexpr int kTaken[] = {SIGTERM, SIGINT, SIGQUIT, SIGPWR, SIGXCPU, SIGHUP, SIGUSR1};

std::optional<Order> order_of(std::uint32_t signal) noexcept {
  switch (signal) {
    case SIGTERM:
    case SIGINT:
    case SIGQUIT:
    case SIGPWR:
    case SIGXCPU:
      return Order::Stop;
    case SIGHUP:
      return Order::Reload;
    case SIGUSR1:
      return Order::SaveMap;
    default:
      return std::nullopt;
  }
}

/// Signals that would end the daemon without a last save, though they mean nothing to it: a broken pipe and a
/// full file are errors of a call, the others are nobody's order.
constexpr std::array kIgnored = {SIGPIPE, SIGXFSZ, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGIO, SIGSTKFLT};

/// Those, and then the real-time signals.
int ignored_signal(std::size_t i) noexcept {
  return i < kIgnored.size() ? kIgnored[i] : SIGRTMIN + static_cast<int>(i - kIgnored.size());
}

}  // namespace

void Signals::ignore_others() {
  before_.resize(kIgnored.size() + static_cast<std::size_t>(SIGRTMAX - SIGRTMIN + 1));
  struct sigaction ignored {};
  ignored.sa_handler = SIG_IGN;
  for (std::size_t i = 0; i < before_.size(); ++i) {
    ::sigaction(ignored_signal(i), &ignored, &before_[i]);
  }
}

tl::expected<Signals, hal::InitError> Signals::create() {
  sigset_t taken;
  sigemptyset(&taken);
  for (const int signal : kTaken) {
    sigaddset(&taken, signal);
  }
  Signals signals;
  const int masked = ::pthread_sigmask(SIG_BLOCK, &taken, &signals.mask_before_);
  if (masked == 0) {
    signals.ignore_others();
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
    for (std::size_t i = 0; i < before_.size(); ++i) {
      ::sigaction(ignored_signal(i), &before_[i], nullptr);
    }
    ::pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
  }
}

std::optional<Order> Signals::take() noexcept {
  signalfd_siginfo info{};
  const ssize_t size = ::read(descriptor_.get(), &info, sizeof info);
  return size == sizeof info ? order_of(info.ssi_signo) : std::nullopt;
}

}  // namespace slamsensor::firmware
