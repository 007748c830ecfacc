#include "hal/transport/serial_port.hpp"

#include "hal/clock.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fcntl.h>
#include <poll.h>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

namespace slamsensor::hal {
namespace {

/// Fills `text` as far as the file goes.
std::string_view read_start(const char* path, std::array<char, 8192>& text) noexcept {
  const int fd = ::open(path, O_RDONLY | O_CLOEXEC);
  std::size_t size = 0;
  for (ssize_t count = 1; fd >= 0 && count > 0 && size < text.size();
       size += static_cast<std::size_t>(count)) {
    count = ::read(fd, text.data() + size, text.size() - size);
    count = count < 0 ? 0 : count;
  }
  if (fd >= 0) {
    ::close(fd);
  }
  return {text.data(), size};
}

/// The name in a line "188 ttyUSB", when its number is `major`.
std::string_view name_in(std::string_view line, unsigned major) noexcept {
  const std::size_t begin = line.find_first_not_of(' ');
  line.remove_prefix(begin == std::string_view::npos ? line.size() : begin);
  unsigned number = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  const auto digits = static_cast<std::size_t>(end - line.data());
  return error == std::errc() && number == major && digits < line.size() ? line.substr(digits + 1)
                                                                         : std::string_view();
}

}  // namespace

DeviceGroup device_group(const char* path) noexcept {
  struct stat status {};
  if (::stat(path, &status) != 0 || !S_ISCHR(status.st_mode)) {
    return {};
  }
  std::array<char, 8192> text{};
  std::string_view rest = read_start("/proc/devices", text);
  rest = rest.substr(0, rest.find("Block devices"));
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    if (const std::string_view name = name_in(rest.substr(0, end), major(status.st_rdev)); !name.empty()) {
      return DeviceGroup(name);
    }
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  return {};
}

namespace {

constexpr std::string_view kKind = "serial port";

constexpr std::array<std::string_view, 12> kEventNames = {"opened",
                                                          "open_failed",
                                                          "hang_ups",
                                                          "io_errors",
                                                          "partial_writes",
                                                          "queue_full",
                                                          "oversized_writes",
                                                          "rate_refused",
                                                          "low_latency_refused",
                                                          "rs485_refused",
                                                          "line_settings_restored",
                                                          "name_moved"};

constexpr Stamp kSettingsPeriod = std::chrono::milliseconds(100);
constexpr Stamp kNamePeriod = std::chrono::seconds(1);

bool is_hang_up(int error) noexcept {
  return error == 0 || error == EIO || error == ENXIO || error == ENODEV;
}

bool is_not_now(int error) noexcept {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

/// Closes a terminal that is this program's own. The mark of exclusive use would outlive the descriptor while
/// anybody else holds the terminal, and lock ourselves out.
void give_back(int fd) noexcept {
  static_cast<void>(set_exclusive(fd, Exclusive::Off));
  ::close(fd);
}

/// A terminal that nobody else has locked; -1 and `failure` when there is none.
int open_locked(const char* path, OpenFailure& failure) noexcept {
  const int fd = ::open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    failure = {"open", errno, {}};
    return -1;
  }
  if (::isatty(fd) == 0) {
    failure = {"not a terminal", ENOTTY, {}};
  } else if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    failure = {"lock", errno, {}};
  } else {
    return fd;
  }
  ::close(fd);
  return -1;
}

}  // namespace

tl::expected<std::unique_ptr<SerialPort>, InitError> SerialPort::create(const SerialConfig& config) {
  const std::string wrong = complaint(config);
  if (!wrong.empty()) {
    return tl::unexpected(InitError{"serial port \"" + config.path + "\": " + wrong});
  }
  return std::unique_ptr<SerialPort>(new SerialPort(config));
}

SerialPort::SerialPort(const SerialConfig& config)
    : config_(config),
      baud_(config.line.baud),
      timer_(config.reopen),
      problem_(describe(kKind, config.path, {"not opened yet", 0, "wait"})),
      counters_(kEventNames) {
}

SerialPort::~SerialPort() {
  close();
}

void SerialPort::service(Stamp now) noexcept {
  look_for_hang_up();
  static_cast<void>(send_rest());
  apply_next_baud();
  keep_settings(now);
  follow_name(now);
  if (is_lost_) {
    is_lost_ = false;
    timer_.lost(now);
  }
  if (fd_ < 0 && timer_.is_due(now)) {
    open(now);
  }
}

void SerialPort::open(Stamp now) noexcept {
  OpenFailure failure;
  const int fd = open_locked(config_.path.c_str(), failure);
  if (fd >= 0) {
    if (const std::optional<OpenFailure> refused = prepare(fd)) {
      failure = *refused;
      give_back(fd);
    } else {
      fd_ = fd;
    }
  }
  if (fd_ < 0) {
    // A file's mode is EACCES; EPERM is the device list of the service.
    const DeniedAdvice denied(failure.error == EPERM ? device_group(config_.path.c_str()).view() : "");
    failure.advice = failure.error == EPERM ? denied.view() : failure.advice;
    problem_ = describe(kKind, config_.path, failure);
    counters_.count(SerialEvent::OpenFailed);
    timer_.failed(now);
    return;
  }
  problem_ = {};
  ++epoch_;
  counters_.count(SerialEvent::Opened);
  timer_.opened(now);
}

/// Makes the terminal `fd`, which is locked, this program's own raw line. A pseudo-terminal keeps the mark of
/// exclusive use after its owner was killed, as long as its other end lives, and only root could open it
/// again: there the lock alone must do.
std::optional<OpenFailure> SerialPort::prepare(int fd) noexcept {
  if (!is_pseudo_terminal(fd)) {
    if (const int error = set_exclusive(fd, Exclusive::On); error != 0) {
      return OpenFailure{"exclusive use", error, {}};
    }
  }
  const LineResult line = make_raw(fd, {baud_, config_.line.format});
  if (line.status == LineStatus::Failed) {
    return OpenFailure{"settings", line.error, {}};
  }
  if (line.status == LineStatus::RateRefused) {
    counters_.count(SerialEvent::RateRefused);
    baud_ =
        config_.line.baud;  // a rate that was tried on another adapter at this place need not be one of this
    return OpenFailure{"the hardware refuses the line rate", 0, "configure a rate that it can do"};
  }
  if (line.status == LineStatus::FormatRefused) {
    return OpenFailure{"the hardware refuses the character format", 0, "configure 8 data bits, no parity"};
  }
  if (config_.latency == SerialLatency::Low && ask_low_latency(fd) != 0) {
    counters_.count(SerialEvent::LowLatencyRefused);
  }
  const std::optional<OpenFailure> failure = make_rs485(fd);
  flush_input(fd);
  return failure;
}

std::optional<OpenFailure> SerialPort::make_rs485(int fd) noexcept {
  const int error = config_.rs485 ? set_rs485(fd, *config_.rs485) : 0;
  if (error == 0) {
    return std::nullopt;
  }
  counters_.count(SerialEvent::Rs485Refused);
  if (is_pseudo_terminal(fd)) {
    return std::nullopt;
  }
  return OpenFailure{"RS-485 mode", error,
                     "if the adapter switches by itself, take rs485 out of the configuration"};
}

void SerialPort::close() noexcept {
  if (fd_ < 0) {
    return;
  }
  flush_output(fd_);  // the kernel would wait for what is still to be sent, up to half a minute
  give_back(fd_);
  fd_ = -1;
  unsent_ = {};
  if (next_baud_ != 0) {
    baud_ = next_baud_;
    next_baud_ = 0;
  }
}

void SerialPort::lose(SerialEvent why, int error) noexcept {
  counters_.count(why);
  const std::string_view doing = why == SerialEvent::HangUp      ? "hung up"
                                 : why == SerialEvent::NameMoved ? "its name leads to another device now"
                                                                 : "read or write";
  problem_ = describe(kKind, config_.path, {doing, error, "check plug and cable; it is opened again"});
  close();
  is_lost_ = true;
}

/// A reader finds a hang-up by itself; a port that is only written to or idle must ask. (What had arrived is
/// gone with a hang-up: the kernel throws it away.)
void SerialPort::look_for_hang_up() noexcept {
  pollfd state{fd_, 0, 0};  // a closed port's -1 is passed over
  if (::poll(&state, 1, 0) > 0) {
    lose(SerialEvent::HangUp, 0);
  }
}

ByteRead SerialPort::read(std::span<std::uint8_t> into) noexcept {
  if (fd_ < 0) {
    return {LinkStatus::Down, 0, {}};
  }
  if (into.empty()) {
    return {};
  }
  const ssize_t count = ::read(fd_, into.data(), into.size());
  if (count > 0) {
    return {LinkStatus::Ok, static_cast<std::size_t>(count), monotonic_now()};
  }
  return {failed_io(count < 0 ? errno : 0), 0, {}};
}

LinkStatus SerialPort::write(std::span<const std::uint8_t> bytes) noexcept {
  if (fd_ < 0) {
    return LinkStatus::Down;
  }
  if (bytes.size() > kWriteMax) {
    counters_.count(SerialEvent::OversizedWrite);
    return LinkStatus::Busy;
  }
  if (send_rest() == LinkStatus::Down) {
    return LinkStatus::Down;
  }
  if (!unsent_.empty() || next_baud_ != 0) {
    counters_.count(SerialEvent::QueueFull);
    return LinkStatus::Busy;
  }
  const ssize_t sent = bytes.empty() ? 0 : ::write(fd_, bytes.data(), bytes.size());
  if (sent < 0) {
    counters_.count(SerialEvent::QueueFull, is_not_now(errno) ? 1 : 0);
    return failed_io(errno);
  }
  const std::span<const std::uint8_t> left = bytes.subspan(static_cast<std::size_t>(sent));
  std::copy(left.begin(), left.end(), rest_.begin());
  unsent_ = std::span(rest_).first(left.size());
  counters_.count(SerialEvent::PartialWrite, left.empty() ? 0 : 1);
  return LinkStatus::Ok;
}

/// Sends what the write before left over, as far as there is room.
LinkStatus SerialPort::send_rest() noexcept {
  if (unsent_.empty()) {
    return LinkStatus::Ok;
  }
  const ssize_t sent = ::write(fd_, unsent_.data(), unsent_.size());
  if (sent < 0) {
    return failed_io(errno);
  }
  unsent_ = unsent_.subspan(static_cast<std::size_t>(sent));
  return LinkStatus::Ok;
}

/// Busy when a read or write only came too early; otherwise the port is lost.
LinkStatus SerialPort::failed_io(int error) noexcept {
  if (is_not_now(error)) {
    return LinkStatus::Busy;
  }
  lose(is_hang_up(error) ? SerialEvent::HangUp : SerialEvent::IoError, error);
  return LinkStatus::Down;
}

LinkStatus SerialPort::set_baud(std::uint32_t baud) noexcept {
  if (!is_line_rate(baud)) {
    counters_.count(SerialEvent::RateRefused);
    return LinkStatus::Down;
  }
  if (fd_ < 0) {
    baud_ = baud;
    return LinkStatus::Down;
  }
  next_baud_ = baud;
  apply_next_baud();
  return fd_ >= 0 && this->baud() == baud ? LinkStatus::Ok : LinkStatus::Down;
}

std::uint32_t SerialPort::baud() const noexcept {
  return next_baud_ != 0 ? next_baud_ : baud_;
}

void SerialPort::apply_next_baud() noexcept {
  if (next_baud_ == 0 || !unsent_.empty() || !has_sent_all(fd_)) {
    return;
  }
  const LineResult result = change_rate(fd_, next_baud_);
  if (result.status == LineStatus::Failed) {
    static_cast<void>(failed_io(result.error));
    return;
  }
  if (result.status == LineStatus::Done) {
    baud_ = next_baud_;
  } else {
    counters_.count(SerialEvent::RateRefused);
  }
  next_baud_ = 0;
}

/// The settings are the terminal's, not this program's: what another one has made of them is seen only by
/// looking.
void SerialPort::keep_settings(Stamp now) noexcept {
  if (fd_ < 0 || next_baud_ != 0 || now < settings_due_) {
    return;
  }
  settings_due_ = now + kSettingsPeriod;
  const SerialLine line{baud_, config_.line.format};
  if (has_settings(fd_, line)) {
    return;
  }
  counters_.count(SerialEvent::SettingsRestored);
  if (const LineResult result = make_raw(fd_, line); result.status == LineStatus::Failed) {
    static_cast<void>(failed_io(result.error));
  } else {
    flush_input(fd_);
  }
}

/// The device behind a stable name may change while the old one stays there and is silent. A name that leads
/// nowhere says nothing: the device itself tells when it goes.
void SerialPort::follow_name(Stamp now) noexcept {
  if (fd_ < 0 || now < name_due_) {
    return;
  }
  name_due_ = now + kNamePeriod;
  struct stat named {};
  struct stat open {};
  if (::stat(config_.path.c_str(), &named) == 0 && ::fstat(fd_, &open) == 0 && S_ISCHR(named.st_mode) &&
      named.st_rdev != open.st_rdev) {
    lose(SerialEvent::NameMoved, 0);
  }
}

void SerialPort::discard_input() noexcept {
  if (fd_ >= 0) {
    flush_input(fd_);
  }
}

}  // namespace slamsensor::hal
