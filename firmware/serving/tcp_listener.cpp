#include "firmware/serving/tcp_listener.hpp"

#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr int kQueued = 16;
constexpr hal::Stamp kRest = std::chrono::seconds(1);  // after accept() failed for want of something

template <typename T>
void set_option(int fd, int level, int name, T value) noexcept {
  static_cast<void>(::setsockopt(fd, level, name, &value, sizeof value));
}

std::string_view advice_for(int error) noexcept {
  switch (error) {
    case EADDRINUSE:
      return "another program has this port: stop it, or configure another; it is tried again";
    case EADDRNOTAVAIL:
    case ENODEV:
      return "this machine does not have the address (yet): correct it or bring the network up; it is tried "
             "again";
    case EACCES:
      return "ports below 1024 take a privilege: configure another";
    default:
      return "it is tried again";
  }
}

hal::OpenFailure failure(std::string_view doing, int error) noexcept {
  return {doing, error, advice_for(error)};
}

}  // namespace

TcpListener::TcpListener(TcpAddress address, std::string_view kind)
    : address_(std::move(address)),
      kind_(kind),
      timer_(hal::ReopenConfig{}),
      problem_(hal::describe(kind, address_.text(), {"not opened yet", 0, "wait"})) {
}

TcpListener::~TcpListener() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
}

bool TcpListener::service(hal::Stamp now) noexcept {
  if (fd_ >= 0 || !timer_.is_due(now)) {
    return false;
  }
  if (const std::optional<hal::OpenFailure> why = open()) {
    problem_ = hal::describe(kind_, address_.text(), *why);
    ++failures_;
    timer_.failed(now);
    return false;
  }
  problem_ = {};
  timer_.opened(now);
  return true;
}

std::optional<hal::OpenFailure> TcpListener::open() noexcept {
  const std::optional<TcpAddress::Raw> raw = address_.raw();
  if (!raw) {
    return failure("look for its interface", ENODEV);
  }
  const int fd = ::socket(raw->storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) {
    return failure("socket", errno);
  }
  // A restart must not wait for the connections of the former run to be forgotten.
  set_option(fd, SOL_SOCKET, SO_REUSEADDR, 1);
  if (raw->storage.ss_family == AF_INET6) {
    set_option(fd, IPPROTO_IPV6, IPV6_V6ONLY, 0);  // "::" is every address, whatever the machine's default
  }
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&raw->storage), raw->size) != 0 ||
      ::listen(fd, kQueued) != 0) {
    const int error = errno;
    ::close(fd);
    return failure("listen", error);
  }
  fd_ = fd;
  return std::nullopt;
}

Accepted TcpListener::accept(hal::Stamp now) noexcept {
  if (poll_fd(now) < 0) {
    return {};
  }
  const int fd = ::accept4(fd_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (fd >= 0) {
    return {AcceptStatus::Client, fd};
  }
  switch (errno) {
    case EAGAIN:
      return {};
    case EMFILE:
    case ENFILE:
    case ENOBUFS:
    case ENOMEM:
      rest_until_ = now + kRest;  // the port stays ready to poll(), which would not wait any more
      return {AcceptStatus::Failed, -1};
    default:
      return {AcceptStatus::Gone, -1};  // the client's own network errors also come this way (accept(2))
  }
}

std::uint16_t TcpListener::port() const noexcept {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (fd_ < 0 || ::getsockname(fd_, reinterpret_cast<sockaddr*>(&storage), &size) != 0) {
    return 0;
  }
  if (storage.ss_family == AF_INET) {
    sockaddr_in v4{};
    std::memcpy(&v4, &storage, sizeof v4);
    return ntohs(v4.sin_port);
  }
  sockaddr_in6 v6{};
  std::memcpy(&v6, &storage, sizeof v6);
  return ntohs(v6.sin6_port);
}

}  // namespace slamsensor::firmware
