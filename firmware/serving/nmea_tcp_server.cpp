#include "firmware/serving/nmea_tcp_server.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <net/if.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr std::uint32_t kPortMax = 65535;

template <typename Address>
TcpAddress::Raw to_raw(const Address& address) noexcept {
  TcpAddress::Raw raw;
  std::memcpy(&raw.storage, &address, sizeof address);
  raw.size = sizeof address;
  return raw;
}

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

constexpr int kReadsMax = 16;             // a step ends although a client talks without pause
constexpr int kKernelBuffer = 16 * 1024;  // of which the kernel books more than the bytes themselves
constexpr int kKeepIdle_s = 30;           // a reader whose machine lost its power is found
constexpr int kKeepInterval_s = 10;       // out within a minute
constexpr int kKeepCount = 3;

bool is_not_now(int error) noexcept {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

constexpr std::array<std::string_view, kNmeaTcpEvents> kNames = {"nmea_tcp_opened",
                                                                 "nmea_tcp_open_failed",
                                                                 "nmea_tcp_clients_accepted",
                                                                 "nmea_tcp_clients_refused",
                                                                 "nmea_tcp_accept_failed",
                                                                 "nmea_tcp_clients_left",
                                                                 "nmea_tcp_clients_displaced",
                                                                 "nmea_tcp_clients_stuck",
                                                                 "nmea_tcp_epochs",
                                                                 "nmea_tcp_bytes",
                                                                 "nmea_tcp_epochs_dropped",
                                                                 "nmea_tcp_bytes_ignored"};

constexpr int kAcceptsMax = 32;  // a step ends although clients come without pause
constexpr hal::Stamp kRefusalsPeriod = std::chrono::minutes(1);

}  // namespace

std::optional<TcpAddress> TcpAddress::parse(const std::string& address, std::uint32_t port) {
  if (port > kPortMax) {
    return std::nullopt;
  }
  TcpAddress result;
  sockaddr_in v4{};
  if (::inet_pton(AF_INET, address.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(static_cast<std::uint16_t>(port));
    result.raw_ = to_raw(v4);
    result.text_ = address + ':' + std::to_string(port);
    return result;
  }
  const std::size_t percent = address.find('%');
  sockaddr_in6 v6{};
  if (::inet_pton(AF_INET6, address.substr(0, percent).c_str(), &v6.sin6_addr) != 1) {
    return std::nullopt;
  }
  if (percent != std::string::npos) {
    result.interface_ = address.substr(percent + 1);
    if (result.interface_.empty() || result.interface_.size() >= IFNAMSIZ) {
      return std::nullopt;
    }
  }
  v6.sin6_family = AF_INET6;
  v6.sin6_port = htons(static_cast<std::uint16_t>(port));
  result.raw_ = to_raw(v6);
  result.text_ = '[' + address + "]:" + std::to_string(port);
  return result;
}

std::optional<TcpAddress::Raw> TcpAddress::raw() const noexcept {
  if (interface_.empty()) {
    return raw_;
  }
  sockaddr_in6 v6{};
  std::memcpy(&v6, &raw_.storage, sizeof v6);
  v6.sin6_scope_id = ::if_nametoindex(interface_.c_str());
  if (v6.sin6_scope_id == 0) {
    return std::nullopt;
  }
  return to_raw(v6);
}

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

tl::expected<std::unique_ptr<NmeaTcpServer>, hal::InitError> NmeaTcpServer::create(
    const NmeaTcpConfig& config) {
  std::optional<TcpAddress> address = TcpAddress::parse(config.address, config.port);
  if (!address) {
    return tl::unexpected(hal::InitError{"NMEA over TCP: cannot listen on address \"" + config.address +
                                         "\" port " + std::to_string(config.port) +
                                         "; give an IPv4 or IPv6 address in numbers (127.0.0.1, 0.0.0.0, "
                                         "::1, ::) and a port from 1 to 65535"});
  }
  if (config.clients_max == 0) {
    return tl::unexpected(hal::InitError{"NMEA over TCP: clients_max 0; allowed are 1 to 64"});
  }
  return std::unique_ptr<NmeaTcpServer>(new NmeaTcpServer(std::move(*address), config.clients_max));
}

NmeaTcpServer::NmeaTcpServer(TcpAddress address, std::size_t clients_max)
    : listener_(std::move(address), "NMEA TCP port"), clients_(clients_max), counters_(kNames) {
}

void NmeaTcpServer::step(hal::Stamp now) noexcept {
  now_ = now;
  const std::uint64_t failures = listener_.failures();
  counters_.count(NmeaTcpEvent::Opened, listener_.service(now) ? 1 : 0);
  counters_.count(NmeaTcpEvent::OpenFailed, listener_.failures() - failures);
  for (TcpClient& client : clients_) {
    if (client.is_open()) {
      look_after(client);
    }
  }
  for (int i = 0; i < kAcceptsMax; ++i) {
    const Accepted accepted = listener_.accept(now);
    if (accepted.status == AcceptStatus::None) {
      break;
    }
    if (accepted.status == AcceptStatus::Client) {
      take_in(accepted.fd);
    } else {
      counters_.count(NmeaTcpEvent::AcceptFailed);
    }
  }
}

void NmeaTcpServer::take_in(int fd) noexcept {
  TcpClient* const place = free_place();
  if (place == nullptr) {
    ::close(fd);
    counters_.count(NmeaTcpEvent::Refused);
    ++refused_;
    return;
  }
  if (place->is_open()) {
    let_go(*place, NmeaTcpEvent::Displaced);
  }
  place->open(fd, now_);
  counters_.count(NmeaTcpEvent::Accepted);
}

/// A closed place, else one whose client has probably left; null when there is neither.
TcpClient* NmeaTcpServer::free_place() noexcept {
  auto place =
      std::find_if(clients_.begin(), clients_.end(), [](const TcpClient& c) { return !c.is_open(); });
  if (place == clients_.end()) {
    place = std::find_if(clients_.begin(), clients_.end(), [](const TcpClient& c) { return c.has_hushed(); });
  }
  return place == clients_.end() ? nullptr : &*place;
}

void NmeaTcpServer::look_after(TcpClient& client) noexcept {
  std::uint64_t ignored = 0;
  const ClientStatus heard = client.drain(ignored);
  counters_.count(NmeaTcpEvent::Ignored, ignored);
  if (heard == ClientStatus::Gone || client.flush(now_) == ClientStatus::Gone) {
    let_go(client, NmeaTcpEvent::Left);
  } else if (client.stuck_for(now_) > kStuckMax) {
    let_go(client, NmeaTcpEvent::Stuck);
  }
}

void NmeaTcpServer::let_go(TcpClient& client, NmeaTcpEvent why) noexcept {
  client.close();
  counters_.count(why);
}

void NmeaTcpServer::send(std::span<const char> epoch, const OutputTime& now) noexcept {
  for (TcpClient& client : clients_) {
    if (!client.is_open()) {
      continue;
    }
    switch (client.send(epoch, now.monotonic)) {
      case ClientStatus::Ok:
        counters_.count(NmeaTcpEvent::Epochs);
        counters_.count(NmeaTcpEvent::Bytes, epoch.size());
        break;
      case ClientStatus::Full:
        counters_.count(NmeaTcpEvent::Dropped);
        break;
      case ClientStatus::Gone:
        let_go(client, NmeaTcpEvent::Left);
        break;
    }
  }
}

std::size_t NmeaTcpServer::poll_on(std::span<pollfd> into) const noexcept {
  std::size_t count = 0;
  const auto add = [&](const pollfd& entry) {
    if (entry.fd >= 0 && count < into.size()) {
      into[count++] = entry;
    }
  };
  add({listener_.poll_fd(now_), POLLIN, 0});
  for (const TcpClient& client : clients_) {
    add(client.poll_on());
  }
  return count;
}

std::string NmeaTcpServer::take_refusals(hal::Stamp now) {
  if (refused_ == 0 || now < refusals_due_) {
    return {};
  }
  refusals_due_ = now + kRefusalsPeriod;
  const std::uint64_t refused = std::exchange(refused_, 0);
  return "NMEA over TCP: " + std::to_string(refused) + (refused == 1 ? " client was" : " clients were") +
         " refused, " + std::to_string(clients()) + " of at most " + std::to_string(clients_.size()) +
         " are connected; end one of them, or connect gpsd, which serves any number of programs";
}

std::size_t NmeaTcpServer::clients() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(clients_.begin(), clients_.end(), [](const TcpClient& c) { return c.is_open(); }));
}

}  // namespace slamsensor::firmware
