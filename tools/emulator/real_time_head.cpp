#include "tools/emulator/real_time_head.hpp"

#include "hal/clock.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr Stamp kLongestWait = std::chrono::milliseconds(20);  // a host that opens a port is seen by then
constexpr std::size_t kPlacesMax = 3;

timespec as_timespec(Stamp time) noexcept {
  constexpr Stamp::rep kSecond = 1'000'000'000;
  return {static_cast<time_t>(time.count() / kSecond), static_cast<long>(time.count() % kSecond)};
}

/// Ahead of ordinary programs while it lives, where the system allows it.
class Priority {
 public:
  Priority() noexcept {
    sched_param lowest{};
    lowest.sched_priority = ::sched_get_priority_min(SCHED_FIFO);
    is_raised_ = ::sched_getscheduler(0) == SCHED_OTHER && ::sched_setscheduler(0, SCHED_FIFO, &lowest) == 0;
  }
  Priority(const Priority&) = delete;
  Priority& operator=(const Priority&) = delete;
  ~Priority() {
    const sched_param ordinary{};
    if (is_raised_) {
      ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
    }
  }

 private:
  bool is_raised_ = false;
};

}  // namespace

tl::expected<std::unique_ptr<RealTimeHead>, WorldError> RealTimeHead::create(EmulatedHead& head,
                                                                             const RealTimeConfig& config) {
  std::unique_ptr<RealTimeHead> made(new RealTimeHead(head, config));
  return made->open_port(head.ptu_port(), config.ptu)
      .and_then([&] { return made->open_port(head.rangefinder_port(), config.rangefinder); })
      .and_then([&] { return made->open_can(); })
      .map([&] { return std::move(made); });
}

tl::expected<void, WorldError> RealTimeHead::open_port(EmulatedPort* port,
                                                       const std::filesystem::path& name) {
  if (port == nullptr) {
    return {};
  }
  auto terminal = PseudoTerminal::create(name);
  if (!terminal) {
    return tl::unexpected(std::move(terminal.error()));
  }
  ports_.push_back(std::make_unique<PtyPort>(*port, std::move(*terminal), config_.baud));
  return {};
}

tl::expected<void, WorldError> RealTimeHead::open_can() {
  if (head_.bus() == nullptr) {
    return {};
  }
  if (config_.can.empty()) {
    return tl::unexpected(
        WorldError{"a device of this head is on a CAN bus: say on which interface (--can vcan0)"});
  }
  hal::CanConfig config;
  config.interface = config_.can;
  auto socket = hal::CanSocket::create(config);
  if (!socket) {
    return tl::unexpected(WorldError{socket.error().message});
  }
  socket_ = std::move(*socket);
  socket_->service(hal::monotonic_now());
  if (!socket_->is_up()) {
    return tl::unexpected(WorldError{std::string(socket_->problem())});
  }
  can_ = std::make_unique<CanPort>(*head_.bus(), *socket_);
  return {};
}

void RealTimeHead::exchange(Stamp real_now) {
  const Stamp now = real_now - origin_;
  head_.advance(now);
  for (const auto& port : ports_) {
    port->exchange(now, lateness_);
  }
  if (can_) {
    can_->exchange(now, real_now, lateness_);
  }
}

void RealTimeHead::wait(Stamp real_now) const {
  std::array<pollfd, kPlacesMax> places{};
  nfds_t count = 0;
  for (const auto& port : ports_) {
    places[count++] = {port->fd(), POLLIN, 0};
  }
  if (socket_) {
    places[count++] = {socket_->fd(), POLLIN, 0};
  }
  // The time that the head has come to may be behind the clock by now: what is due is due at once.
  const Stamp due = std::min(head_.next_event(), head_.next_delivery());
  const Stamp begun = head_.clock().now;
  const Stamp wake = std::clamp(due, begun + config_.granule, begun + kLongestWait);
  const timespec left = as_timespec(std::max(wake - (real_now - origin_), Stamp{}));
  sigset_t none;
  sigemptyset(&none);
  static_cast<void>(::ppoll(places.data(), count, &left, &none));
}

void RealTimeHead::run(Stamp end, Orders& orders) {
  const Priority priority;
  static_cast<void>(::prctl(PR_SET_TIMERSLACK, 1UL));  // else the kernel wakes us 50 us late to save power
  if (origin_ == hal::kNever) {
    origin_ = hal::monotonic_now() - head_.clock().now;
  }
  const Stamp real_end = end < hal::kNever - origin_ ? origin_ + end : hal::kNever;
  while (orders.stop == 0 && head_.clock().now < end) {
    exchange(std::min(hal::monotonic_now(), real_end));
    if (orders.next_stand != 0) {
      orders.next_stand = 0;
      head_.next_stand();
    }
    wait(hal::monotonic_now());
  }
}

std::uint64_t RealTimeHead::lost() const noexcept {
  std::uint64_t lost = can_ ? can_->lost_frames() : 0;
  for (const auto& port : ports_) {
    lost += port->lost_bytes();
  }
  return lost;
}

}  // namespace slamsensor::tools
