#include "firmware/serving/tcp_client.hpp"

#include <algorithm>
#include <cerrno>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

namespace slamsensor::firmware {
namespace {

constexpr int kReadsMax = 16;             // a step ends although a client talks without pause
constexpr int kKernelBuffer = 16 * 1024;  // of which the kernel books more than the bytes themselves
constexpr int kKeepIdle_s = 30;           // a reader whose machine lost its power is found
constexpr int kKeepInterval_s = 10;       // out within a minute
constexpr int kKeepCount = 3;

void set_option(int fd, int level, int name, int value) noexcept {
  static_cast<void>(::setsockopt(fd, level, name, &value, sizeof value));
}

bool is_not_now(int error) noexcept {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

void TcpClient::open(int fd, hal::Stamp now) noexcept {
  fd_ = fd;
  has_hushed_ = false;
  progress_ = now;
  begin_ = end_ = 0;
  set_option(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(fd, SOL_SOCKET, SO_SNDBUF, kKernelBuffer);
  set_option(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(fd, IPPROTO_TCP, TCP_KEEPIDLE, kKeepIdle_s);
  set_option(fd, IPPROTO_TCP, TCP_KEEPINTVL, kKeepInterval_s);
  set_option(fd, IPPROTO_TCP, TCP_KEEPCNT, kKeepCount);
}

void TcpClient::close() noexcept {
  if (fd_ >= 0) {
    ::close(fd_);
    fd_ = -1;
  }
}

ClientStatus TcpClient::send(std::span<const char> bytes, hal::Stamp now) noexcept {
  if (flush(now) == ClientStatus::Gone) {
    return ClientStatus::Gone;
  }
  if (waiting() + bytes.size() > buffer_.size()) {
    return ClientStatus::Full;
  }
  if (end_ + bytes.size() > buffer_.size()) {
    std::copy(buffer_.data() + begin_, buffer_.data() + end_, buffer_.data());
    end_ -= begin_;
    begin_ = 0;
  }
  if (waiting() == 0) {
    progress_ = now;
  }
  std::copy(bytes.begin(), bytes.end(), buffer_.data() + end_);
  end_ += bytes.size();
  return flush(now);
}

ClientStatus TcpClient::flush(hal::Stamp now) noexcept {
  while (waiting() > 0) {
    const ssize_t sent = ::send(fd_, buffer_.data() + begin_, waiting(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0) {
      return is_not_now(errno) ? ClientStatus::Ok : ClientStatus::Gone;
    }
    begin_ += static_cast<std::size_t>(sent);
    progress_ = now;
  }
  begin_ = end_ = 0;
  return ClientStatus::Ok;
}

ClientStatus TcpClient::drain(std::uint64_t& ignored) noexcept {
  std::array<char, 512> input{};
  for (int i = 0; i < kReadsMax && !has_hushed_; ++i) {
    const ssize_t count = ::recv(fd_, input.data(), input.size(), MSG_DONTWAIT);
    if (count < 0) {
      return is_not_now(errno) ? ClientStatus::Ok : ClientStatus::Gone;
    }
    has_hushed_ = count == 0;
    ignored += static_cast<std::uint64_t>(count);
  }
  if (!has_hushed_) {
    return ClientStatus::Ok;
  }
  // A reader may close its own side and read on (nc -N); one that has left answers what is sent with a reset.
  pollfd state{fd_, 0, 0};
  const bool is_over = ::poll(&state, 1, 0) > 0 && (state.revents & (POLLERR | POLLHUP)) != 0;
  return is_over ? ClientStatus::Gone : ClientStatus::Ok;
}

hal::Stamp TcpClient::stuck_for(hal::Stamp now) const noexcept {
  return waiting() > 0 ? now - progress_ : hal::Stamp{};
}

pollfd TcpClient::poll_on() const noexcept {
  const int events = (has_hushed_ ? 0 : POLLIN) | (waiting() > 0 ? POLLOUT : 0);
  return {fd_, static_cast<short>(events), 0};
}

}  // namespace slamsensor::firmware
