#include "tools/emulator/real_time_head.hpp"

#include "hal/clock.hpp"
#include "tools/output/text_output.hpp"

#include <algorithm>
#include <asm/termbits.h>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace slamsensor::tools {

void Lateness::count(hal::Stamp late, std::uint64_t times) noexcept {
  const double late_ms = hal::to_seconds(late) * 1e3;
  const auto bound = std::lower_bound(kBounds_ms.begin(), kBounds_ms.end(), late_ms);
  counts_[static_cast<std::size_t>(bound - kBounds_ms.begin())] += times;
  total_ += times;
  worst_ = std::max(worst_, late);
}

hal::Stamp Lateness::within(double share) const noexcept {
  const double wanted = share * static_cast<double>(total_);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < kBounds_ms.size() && total_ > 0; ++i) {
    sum += counts_[i];
    if (static_cast<double>(sum) >= wanted) {
      return hal::from_seconds(kBounds_ms[i] * 1e-3);
    }
  }
  return total_ > 0 ? hal::kNever : hal::Stamp{};
}

std::string Lateness::text() const {
  if (total_ == 0) {
    return "nothing was sent";
  }
  std::string text = "worst " + fixed_text(hal::to_seconds(worst_) * 1e3, 2) + " ms;";
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] > 0) {
      const bool beyond = i == kBounds_ms.size();
      text += beyond ? " beyond " : " up to ";
      append_shortest(text, kBounds_ms[beyond ? i - 1 : i]);
      text += " ms: ";
      append_integer(text, counts_[i]);
    }
  }
  return text;
}

namespace {

constexpr int kFramesMax = 1000;  // of the interface in one exchange

}  // namespace

CanPort::CanPort(MemoryCanBus& bus, hal::CanLink& link) : bus_(bus), link_(link), host_(bus.add_host()) {
}

void CanPort::exchange(Stamp now, Stamp real_now, Lateness& late) {
  link_.service(real_now);
  while (const auto arrival = bus_.host_take(host_)) {
    late.count(now - arrival->at);
    lost_frames_ += link_.send(arrival->frame) == hal::LinkStatus::Ok ? 0U : 1U;
  }
  for (int i = 0; i < kFramesMax; ++i) {
    const hal::CanRead read = link_.receive();
    if (read.status != hal::LinkStatus::Ok) {
      return;
    }
    lost_frames_ += bus_.host_send(host_, read.frame, now) ? 0U : 1U;
  }
}

namespace {

constexpr std::uint32_t kFirstBaud = 9600;  // of a serial port that nobody has set
constexpr std::string_view kTerminals = "/dev/pts/";

std::string failure(std::string_view what) {
  return std::string(what) + ": " + std::strerror(errno);
}

/// 8 bits, nothing added, changed or taken away.
bool make_raw(int fd) noexcept {
  termios2 settings{};
  if (::ioctl(fd, TCGETS2, &settings) != 0) {
    return false;
  }
  settings.c_iflag = 0;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
  settings.c_ispeed = kFirstBaud;
  settings.c_ospeed = kFirstBaud;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  return ::ioctl(fd, TCSETS2, &settings) == 0;
}

/// Only from its first opening on does a terminal show whether a host is there.
bool open_once(const char* path) noexcept {
  const int fd = ::open(path, O_RDWR | O_NOCTTY | O_CLOEXEC);
  return fd >= 0 && ::close(fd) == 0;
}

bool is_left_over(const std::filesystem::path& name) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::read_symlink(name, error);
  return !error && target.native().starts_with(kTerminals);
}

}  // namespace

tl::expected<std::unique_ptr<PseudoTerminal>, WorldError> PseudoTerminal::create(
    const std::filesystem::path& name) {
  std::error_code error;
  const bool exists = std::filesystem::exists(std::filesystem::symlink_status(name, error));
  if (exists && !is_left_over(name)) {
    return tl::unexpected(
        WorldError{name.string() + " exists and is no link to a terminal; choose another path"});
  }
  std::unique_ptr<PseudoTerminal> terminal(new PseudoTerminal(name));
  std::string wrong = terminal->open_terminal();
  wrong = wrong.empty() ? terminal->make_link() : wrong;
  if (!wrong.empty()) {
    return tl::unexpected(WorldError{name.string() + ": " + wrong});
  }
  return terminal;
}

PseudoTerminal::~PseudoTerminal() {
  unplug();
}

std::string PseudoTerminal::open_terminal() noexcept {
  fd_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> path{};
  if (fd_ < 0 || ::grantpt(fd_) != 0 || ::unlockpt(fd_) != 0 ||
      ::ptsname_r(fd_, path.data(), path.size()) != 0) {
    return failure("no pseudo-terminal can be had");
  }
  target_ = path.data();
  if (!open_once(path.data()) || !make_raw(fd_)) {
    return failure(target_ + " cannot be set up");
  }
  return {};
}

std::string PseudoTerminal::make_link() noexcept {
  // A new link takes the name in one step, so that nobody finds it missing.
  const std::string fresh = name_.string() + ".new";
  static_cast<void>(::unlink(fresh.c_str()));
  if (::symlink(target_.c_str(), fresh.c_str()) != 0 || ::rename(fresh.c_str(), name_.c_str()) != 0) {
    return failure("the link cannot be made");
  }
  return {};
}

bool PseudoTerminal::plug_in() noexcept {
  if (!is_plugged() && (!open_terminal().empty() || !make_link().empty())) {
    unplug();
  }
  return is_plugged();
}

void PseudoTerminal::unplug() noexcept {
  if (fd_ < 0) {
    return;
  }
  std::error_code error;
  if (std::filesystem::read_symlink(name_, error) == target_ && !error) {
    static_cast<void>(::unlink(name_.c_str()));
  }
  ::close(std::exchange(fd_, -1));
}

bool PseudoTerminal::has_host() const noexcept {
  pollfd state{fd_, POLLIN, 0};
  return fd_ >= 0 && ::poll(&state, 1, 0) >= 0 && (state.revents & POLLHUP) == 0;
}

std::optional<std::uint32_t> PseudoTerminal::host_baud() const noexcept {
  termios2 settings{};
  if (fd_ < 0 || ::ioctl(fd_, TCGETS2, &settings) != 0) {
    return std::nullopt;
  }
  return settings.c_ospeed;
}

std::size_t PseudoTerminal::read(std::span<std::uint8_t> into) noexcept {
  const ssize_t count = fd_ >= 0 ? ::read(fd_, into.data(), into.size()) : -1;
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::size_t PseudoTerminal::write(std::span<const std::uint8_t> bytes) noexcept {
  const ssize_t count = fd_ >= 0 ? ::write(fd_, bytes.data(), bytes.size()) : -1;
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

namespace {

constexpr std::size_t kChunk = 1024;  // bytes moved at a time

}  // namespace

PtyPort::PtyPort(EmulatedPort& port, std::unique_ptr<PseudoTerminal> terminal, BaudRule rule)
    : port_(port), terminal_(std::move(terminal)), rule_(rule), plug_count_(port.plug_count()) {
}

void PtyPort::follow_cable() {
  // A cable that was out and in again since the last time is a new terminal, too.
  if (!port_.is_plugged() || port_.plug_count() != plug_count_) {
    terminal_->unplug();
  }
  plug_count_ = port_.plug_count();
  if (port_.is_plugged() && !terminal_->is_plugged()) {
    terminal_->plug_in();
  }
}

void PtyPort::exchange(Stamp now, Lateness& late) {
  follow_cable();
  has_host_ = terminal_->has_host();
  if (has_host_) {
    speak(now, late);
  } else {
    port_.host_discard();
  }
  listen(now);  // also the last words of a host that has gone
}

void PtyPort::speak(Stamp now, Lateness& late) {
  std::array<WireByte, kChunk> due;
  std::array<std::uint8_t, kChunk> bytes;
  for (std::size_t count = due.size(); count == due.size();) {
    count = port_.host_take(due, now);
    for (std::size_t i = 0; i < count; ++i) {
      bytes[i] = due[i].value;
      late.count(now - due[i].at);
    }
    if (count > 0) {
      lost_bytes_ += count - terminal_->write({bytes.data(), count});
    }
  }
}

void PtyPort::listen(Stamp now) {
  const auto host_baud = rule_ == BaudRule::AsOnALine ? terminal_->host_baud() : port_.device_baud();
  if (host_baud) {
    port_.set_host_baud(*host_baud);
  }
  std::array<std::uint8_t, kChunk> bytes;
  const std::size_t count = terminal_->read(bytes);
  port_.host_write({bytes.data(), count}, now);
}

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
