#include "hal/transport/can_socket.hpp"

#include "hal/clock.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

namespace slamsensor::hal {
namespace {

bool is_interface_name(const std::string& name) {
  return !name.empty() && name.size() < IFNAMSIZ && name != "." && name != ".." &&
         std::none_of(name.begin(), name.end(),
                      [](char c) { return c == '/' || c == ':' || c <= ' ' || c > '~'; });
}

}  // namespace

std::string complaint(const CanConfig& config) {
  if (!is_interface_name(config.interface)) {
    return "the name must be that of a network interface, 1 to 15 characters";
  }
  if (config.filters.size() > kCanFiltersMax) {
    return std::to_string(config.filters.size()) + " filters; at most " + std::to_string(kCanFiltersMax) +
           " are possible";
  }
  for (const CanFilter& filter : config.filters) {
    if ((filter.id | filter.mask) > (filter.extended ? CAN_EFF_MASK : CAN_SFF_MASK)) {
      return "a filter's id or mask has more than " + std::string(filter.extended ? "29" : "11") + " bits";
    }
  }
  if (!is_valid(config.reopen)) {
    return std::string(kReopenRule);
  }
  return {};
}

namespace {

constexpr Stamp kAgeMax = std::chrono::seconds(2);

constexpr std::array<std::string_view, kCanEvents> kNames = {
    "opened",         "open_failed", "interface_lost", "io_errors",     "bus_off",      "restarted",
    "rx_overflow",    "tx_overflow", "error_warning",  "error_passive", "error_active", "no_ack",
    "tx_timeout",     "bus_errors",  "remote_ignored", "fd_ignored",    "bad_frames",   "stamps_refused",
    "frames_dropped", "queue_full",  "send_refused"};

struct ErrorBit {
  std::uint32_t bit;
  CanEvent event;
};

constexpr std::array<ErrorBit, 7> kClasses = {{{CAN_ERR_TX_TIMEOUT, CanEvent::TxTimeout},
                                               {CAN_ERR_ACK, CanEvent::NoAck},
                                               {CAN_ERR_PROT, CanEvent::BusError},
                                               {CAN_ERR_TRX, CanEvent::BusError},
                                               {CAN_ERR_BUSERROR, CanEvent::BusError},
                                               {CAN_ERR_BUSOFF, CanEvent::BusOff},
                                               {CAN_ERR_RESTARTED, CanEvent::Restarted}}};

constexpr std::array<ErrorBit, 5> kController = {
    {{CAN_ERR_CRTL_RX_OVERFLOW, CanEvent::RxOverflow},
     {CAN_ERR_CRTL_TX_OVERFLOW, CanEvent::TxOverflow},
     {CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING, CanEvent::ErrorWarning},
     {CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE, CanEvent::ErrorPassive},
     {CAN_ERR_CRTL_ACTIVE, CanEvent::ErrorActive}}};

void count_bits(std::span<const ErrorBit> table, std::uint32_t bits, CanCounters& counters) noexcept {
  for (const ErrorBit& entry : table) {
    if ((bits & entry.bit) != 0) {
      counters.count(entry.event);
    }
  }
}

}  // namespace

const std::array<std::string_view, kCanEvents>& can_event_names() noexcept {
  return kNames;
}

std::optional<CanFrame> to_data_frame(const canfd_frame& raw, std::size_t bytes,
                                      CanCounters& counters) noexcept {
  if (bytes == CANFD_MTU) {
    counters.count(CanEvent::FdIgnored);
    return std::nullopt;
  }
  if (bytes != CAN_MTU || raw.len > CAN_MAX_DLEN) {
    counters.count(CanEvent::BadFrame);
    return std::nullopt;
  }
  if ((raw.can_id & CAN_RTR_FLAG) != 0) {
    counters.count(CanEvent::RemoteIgnored);
    return std::nullopt;
  }
  CanFrame frame;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = raw.len;
  std::copy_n(raw.data, frame.size, frame.data.begin());
  return frame;
}

bool is_error_frame(const canfd_frame& raw, std::size_t bytes) noexcept {
  return bytes == CAN_MTU && (raw.can_id & CAN_ERR_FLAG) != 0;
}

BusState take_error_frame(const canfd_frame& raw, CanCounters& counters) noexcept {
  count_bits(kClasses, raw.can_id, counters);
  if ((raw.can_id & CAN_ERR_CRTL) != 0) {
    count_bits(kController, raw.data[1], counters);
  }
  return (raw.can_id & (CAN_ERR_BUSOFF | CAN_ERR_RESTARTED)) != 0 ? BusState::Off : BusState::On;
}

std::optional<can_frame> to_raw(const CanFrame& frame) noexcept {
  if (frame.size > CAN_MAX_DLEN || frame.id > (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK)) {
    return std::nullopt;
  }
  can_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
  raw.len = frame.size;
  std::copy_n(frame.data.begin(), frame.size, raw.data);
  return raw;
}

std::optional<Stamp> monotonic_stamp(Stamp arrived, Stamp realtime_ahead, Stamp now) noexcept {
  const Stamp stamp = arrived - realtime_ahead;
  if (stamp > now || now - stamp > kAgeMax) {
    return std::nullopt;
  }
  return stamp;
}

/// One message of the socket and what came beside it.
struct CanSocket::Received {
  canfd_frame frame{};
  std::size_t bytes = 0;
  std::optional<Stamp> realtime;
};

namespace {

constexpr std::string_view kKind = "CAN interface";
constexpr int kSkippedMax = 64;
constexpr OpenFailure kBusOff = {"bus-off", 0,
                                 "set restart-ms; check bit rate, wiring and terminating resistors"};
constexpr can_err_mask_t kErrors = CAN_ERR_TX_TIMEOUT | CAN_ERR_CRTL | CAN_ERR_PROT | CAN_ERR_TRX |
                                   CAN_ERR_ACK | CAN_ERR_BUSOFF | CAN_ERR_BUSERROR | CAN_ERR_RESTARTED;

can_filter raw_filter(const CanFilter& filter) noexcept {
  // The kind of identifier is part of the match; without its bit the mask would let both kinds pass.
  return {filter.id | (filter.extended ? CAN_EFF_FLAG : 0U), filter.mask | CAN_EFF_FLAG};
}

template <typename T>
bool set_option(int fd, int level, int name, const T& value) noexcept {
  return ::setsockopt(fd, level, name, &value, sizeof value) == 0;
}

bool set_filters(int fd, std::span<const CanFilter> filters) noexcept {
  if (filters.empty()) {
    return true;  // a new socket passes every frame
  }
  std::array<can_filter, kCanFiltersMax> raw{};
  std::transform(filters.begin(), filters.end(), raw.begin(), raw_filter);
  return ::setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, raw.data(),
                      static_cast<socklen_t>(filters.size() * sizeof raw[0])) == 0;
}

bool set_options(int fd, std::span<const CanFilter> filters) noexcept {
  constexpr int kOn = 1;
  constexpr int kOff = 0;
  return set_filters(fd, filters) && set_option(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kErrors) &&
         set_option(fd, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, kOff) &&
         set_option(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, kOn) &&  // to count them; else they are hidden
         set_option(fd, SOL_SOCKET, SO_TIMESTAMPNS, kOn) && set_option(fd, SOL_SOCKET, SO_RXQ_OVFL, kOn);
}

ifreq request_for(const std::string& interface) noexcept {
  ifreq request{};
  std::memcpy(request.ifr_name, interface.data(), std::min<std::size_t>(interface.size(), IFNAMSIZ - 1));
  return request;
}

bool is_interface_error(int error) noexcept {
  return error == ENETDOWN || error == ENODEV || error == ENXIO;
}

/// The value of a control message of another size is not taken.
template <typename T>
std::optional<T> value_of(const cmsghdr& message) noexcept {
  if (message.cmsg_len != CMSG_LEN(sizeof(T))) {
    return std::nullopt;
  }
  T value;
  std::memcpy(&value, CMSG_DATA(&message), sizeof value);
  return value;
}

std::optional<Stamp> time_of(const std::optional<timespec>& time) noexcept {
  if (!time) {
    return std::nullopt;
  }
  return std::chrono::seconds(time->tv_sec) + Stamp(time->tv_nsec);
}

}  // namespace

tl::expected<std::unique_ptr<CanSocket>, InitError> CanSocket::create(const CanConfig& config) {
  const std::string wrong = complaint(config);
  if (!wrong.empty()) {
    return tl::unexpected(InitError{"CAN interface \"" + config.interface + "\": " + wrong});
  }
  return std::unique_ptr<CanSocket>(new CanSocket(config));
}

CanSocket::CanSocket(const CanConfig& config)
    : config_(config),
      timer_(config.reopen),
      problem_(describe(kKind, config.interface, {"not opened yet", 0, "wait"})),
      counters_(can_event_names()) {
}

CanSocket::~CanSocket() {
  close();
}

void CanSocket::service(Stamp now) noexcept {
  look_for_error();
  if (is_lost_) {
    is_lost_ = false;
    timer_.lost(now);
  }
  if (fd_ >= 0 || !timer_.is_due(now)) {
    return;
  }
  const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  const std::optional<OpenFailure> failure = fd < 0 ? OpenFailure{"socket", errno, {}} : prepare(fd);
  if (failure) {
    problem_ = describe(kKind, config_.interface, *failure);
    counters_.count(CanEvent::OpenFailed);
    timer_.failed(now);
    if (fd >= 0) {
      ::close(fd);
    }
    return;
  }
  fd_ = fd;
  dropped_ = 0;
  problem_ = {};
  ++epoch_;
  counters_.count(CanEvent::Opened);
  timer_.opened(now);
}

std::optional<OpenFailure> CanSocket::prepare(int fd) noexcept {
  if (!set_options(fd, config_.filters)) {
    return OpenFailure{"socket options", errno, {}};
  }
  ifreq request = request_for(config_.interface);
  if (::ioctl(fd, SIOCGIFINDEX, &request) != 0) {
    return OpenFailure{"look for it", errno, {}};
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return OpenFailure{"bind", errno, {}};
  }
  // After bind, so that no going down is missed in between: it leaves an error on the socket.
  if (::ioctl(fd, SIOCGIFFLAGS, &request) != 0) {
    return OpenFailure{"look at its state", errno, {}};
  }
  if ((request.ifr_flags & IFF_UP) == 0) {
    return OpenFailure{"down", ENETDOWN, {}};
  }
  if ((request.ifr_flags & IFF_RUNNING) == 0) {
    return kBusOff;
  }
  return std::nullopt;
}

CanRead CanSocket::receive() noexcept {
  for (int i = 0; i < kSkippedMax; ++i) {
    Received received;
    const LinkStatus status = take(received);
    if (status != LinkStatus::Ok) {
      return {status, {}, {}};
    }
    if (is_error_frame(received.frame, received.bytes)) {
      if (take_error_frame(received.frame, counters_) == BusState::Off) {
        lose(kBusOff);
        return {LinkStatus::Down, {}, {}};
      }
    } else if (const auto frame = to_data_frame(received.frame, received.bytes, counters_)) {
      return {LinkStatus::Ok, *frame, stamp_of(received)};
    }
  }
  return {};
}

/// Reads one message, Ok, without waiting.
LinkStatus CanSocket::take(Received& received) noexcept {
  if (fd_ < 0) {
    return LinkStatus::Down;
  }
  iovec part{&received.frame, sizeof received.frame};
  alignas(cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))>
      beside;
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = beside.data();
  message.msg_controllen = beside.size();
  const ssize_t bytes = ::recvmsg(fd_, &message, MSG_DONTWAIT);
  if (bytes < 0) {
    return failed_io(errno);
  }
  received.bytes = static_cast<std::size_t>(bytes);
  for (cmsghdr* side = CMSG_FIRSTHDR(&message); side != nullptr; side = CMSG_NXTHDR(&message, side)) {
    if (side->cmsg_level != SOL_SOCKET) {
      continue;
    }
    if (side->cmsg_type == SCM_TIMESTAMPNS) {
      received.realtime = time_of(value_of<timespec>(*side));
    } else if (side->cmsg_type == SO_RXQ_OVFL) {
      const std::uint32_t dropped = value_of<std::uint32_t>(*side).value_or(dropped_);
      counters_.count(CanEvent::Dropped, dropped - dropped_);  // the kernel's count may wrap, as this does
      dropped_ = dropped;
    }
  }
  return LinkStatus::Ok;
}

Stamp CanSocket::stamp_of(const Received& received) noexcept {
  const Stamp ahead = realtime_ahead();
  const Stamp now = monotonic_now();
  const std::optional<Stamp> stamp =
      received.realtime ? monotonic_stamp(*received.realtime, ahead, now) : std::nullopt;
  counters_.count(CanEvent::StampRefused, stamp ? 0 : 1);
  return stamp.value_or(now);
}

LinkStatus CanSocket::send(const CanFrame& frame) noexcept {
  if (fd_ < 0) {
    return LinkStatus::Down;
  }
  const std::optional<can_frame> raw = to_raw(frame);
  if (!raw) {
    counters_.count(CanEvent::SendRefused);
    return LinkStatus::Down;
  }
  if (::send(fd_, &*raw, sizeof *raw, MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(sizeof *raw)) {
    return LinkStatus::Ok;
  }
  const int error = errno;
  const LinkStatus status = failed_io(error);
  counters_.count(CanEvent::QueueFull, status == LinkStatus::Busy ? 1 : 0);
  return status;
}

/// Busy when a call only came too early; otherwise the link is lost.
LinkStatus CanSocket::failed_io(int error) noexcept {
  if (error == EAGAIN || error == EWOULDBLOCK || error == EINTR || error == ENOBUFS) {
    return LinkStatus::Busy;
  }
  counters_.count(is_interface_error(error) ? CanEvent::InterfaceLost : CanEvent::IoError);
  lose({"lost", error, {}});
  return LinkStatus::Down;
}

/// A receiver finds a lost interface by itself; a socket that is only sent to or idle must ask.
void CanSocket::look_for_error() noexcept {
  pollfd state{fd_, 0, 0};  // a closed socket's -1 is passed over
  if (::poll(&state, 1, 0) <= 0) {
    return;
  }
  int error = 0;
  socklen_t size = sizeof error;
  if (::getsockopt(fd_, SOL_SOCKET, SO_ERROR, &error, &size) != 0) {
    error = errno;
  }
  if (error != 0) {
    static_cast<void>(failed_io(error));
  }
}

void CanSocket::lose(const OpenFailure& failure) noexcept {
  problem_ = describe(kKind, config_.interface, failure);
  close();
  is_lost_ = true;
}

void CanSocket::close() noexcept {
  if (fd_ >= 0) {
    ::close(fd_);
    fd_ = -1;
  }
}

}  // namespace slamsensor::hal
