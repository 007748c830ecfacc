#include "hal/transport/serial_line.hpp"

#include "hal/transport/reopen.hpp"

#include <algorithm>
#include <asm/termbits.h>
#include <cerrno>
#include <linux/serial.h>
#include <linux/tty_flags.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

// The only file that sees the kernel's termios2: it and the C library's <termios.h> exclude each other.

namespace slamsensor::hal {
namespace {

constexpr tcflag_t kFormatBits = CSIZE | PARENB | PARODD | CMSPAR | CSTOPB;
constexpr tcflag_t kInputBits =
    IGNBRK | BRKINT | IGNPAR | PARMRK | INPCK | ISTRIP | INLCR | IGNCR | ICRNL | IUCLC | IXON | IXANY | IXOFF;
constexpr tcflag_t kLocalBits = ISIG | ICANON | ECHO | ECHOE | ECHOK | ECHONL | NOFLSH | TOSTOP | IEXTEN;

tcflag_t format_bits(const SerialFormat& format) noexcept {
  tcflag_t bits = format.data_bits == 7 ? CS7 : CS8;
  if (format.parity != SerialParity::None) {
    bits |= PARENB;
  }
  if (format.parity == SerialParity::Odd) {
    bits |= PARODD;
  }
  if (format.stop_bits == 2) {
    bits |= CSTOPB;
  }
  return bits;
}

void put_rate(termios2& settings, std::uint32_t baud) noexcept {
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD | (CBAUD << IBSHIFT));
  settings.c_cflag |= BOTHER | (BOTHER << IBSHIFT);
  settings.c_ispeed = baud;
  settings.c_ospeed = baud;
}

void put_raw(termios2& settings, const SerialLine& line) noexcept {
  // A byte with a wrong parity or a break comes as a zero byte instead (INPCK off: as it is); the protocols'
  // own checks catch both.
  settings.c_iflag &= ~kInputBits;
  settings.c_oflag &= ~static_cast<tcflag_t>(OPOST);
  settings.c_lflag &= ~kLocalBits;
  // HUPCL off: a close would drop DTR, which resets some devices.
  settings.c_cflag &= ~(kFormatBits | CRTSCTS | HUPCL);
  settings.c_cflag |= CREAD | CLOCAL | format_bits(line.format);
  // With VMIN 0 an empty line and a hang-up would look the same: both read 0 bytes.
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  put_rate(settings, line.baud);
}

bool is_raw(const termios2& settings) noexcept {
  return (settings.c_iflag & kInputBits) == 0 && (settings.c_oflag & OPOST) == 0 &&
         (settings.c_lflag & kLocalBits) == 0 && (settings.c_cflag & (CRTSCTS | HUPCL)) == 0 &&
         (settings.c_cflag & CREAD) != 0 && (settings.c_cflag & CLOCAL) != 0 && settings.c_cc[VMIN] == 1 &&
         settings.c_cc[VTIME] == 0;
}

bool is_near(speed_t actual, std::uint32_t asked) noexcept {
  const std::uint64_t off = actual > asked ? actual - asked : asked - actual;
  return off * 100 <= std::uint64_t{asked} * 3;
}

}  // namespace

bool has_settings(int fd, const SerialLine& line) noexcept {
  termios2 settings{};
  if (::ioctl(fd, TCGETS2, &settings) != 0) {
    return true;  // a lost port is found by reading
  }
  const bool has_format = (settings.c_cflag & kFormatBits) == format_bits(line.format);
  return is_raw(settings) && is_near(settings.c_ospeed, line.baud) && (has_format || is_pseudo_terminal(fd));
}

LineResult make_raw(int fd, const SerialLine& line) noexcept {
  termios2 settings{};
  if (::ioctl(fd, TCGETS2, &settings) != 0) {
    return {LineStatus::Failed, errno};
  }
  put_raw(settings, line);
  termios2 taken{};
  if (::ioctl(fd, TCSETS2, &settings) != 0 || ::ioctl(fd, TCGETS2, &taken) != 0) {
    return {LineStatus::Failed, errno};
  }
  if (!is_near(taken.c_ospeed, line.baud)) {
    return {LineStatus::RateRefused, 0};
  }
  const bool same_format = ((taken.c_cflag ^ settings.c_cflag) & kFormatBits) == 0;
  if (!is_raw(taken) || (!same_format && !is_pseudo_terminal(fd))) {
    return {LineStatus::FormatRefused, 0};
  }
  return {};
}

LineResult change_rate(int fd, std::uint32_t baud) noexcept {
  termios2 before{};
  if (::ioctl(fd, TCGETS2, &before) != 0) {
    return {LineStatus::Failed, errno};
  }
  termios2 settings = before;
  put_rate(settings, baud);
  termios2 taken{};
  if (::ioctl(fd, TCSETS2, &settings) != 0 || ::ioctl(fd, TCGETS2, &taken) != 0) {
    return {LineStatus::Failed, errno};
  }
  if (!is_near(taken.c_ospeed, baud)) {
    ::ioctl(fd, TCSETS2, &before);
    return {LineStatus::RateRefused, 0};
  }
  return {};
}

bool has_sent_all(int fd) noexcept {
  int waiting = 0;
  if (::ioctl(fd, TIOCOUTQ, &waiting) == 0 && waiting > 0) {
    return false;
  }
  unsigned int state = 0;  // the queue above can be empty while the hardware still shifts bits out
  return ::ioctl(fd, TIOCSERGETLSR, &state) != 0 || (state & TIOCSER_TEMT) != 0;
}

int ask_low_latency(int fd) noexcept {
  serial_struct settings{};
  if (::ioctl(fd, TIOCGSERIAL, &settings) != 0) {
    return errno;
  }
  settings.flags |= static_cast<int>(ASYNC_LOW_LATENCY);
  return ::ioctl(fd, TIOCSSERIAL, &settings) == 0 ? 0 : errno;
}

int set_rs485(int fd, const Rs485Config& config) noexcept {
  serial_rs485 settings{};
  settings.flags = SER_RS485_ENABLED;
  settings.flags |= config.rts_while_sending == Rs485Level::High ? SER_RS485_RTS_ON_SEND : 0U;
  settings.flags |= config.rts_after_sending == Rs485Level::High ? SER_RS485_RTS_AFTER_SEND : 0U;
  settings.flags |= config.receive_own == Rs485Echo::On ? SER_RS485_RX_DURING_TX : 0U;
  settings.delay_rts_before_send = config.delay_before_send_ms;
  settings.delay_rts_after_send = config.delay_after_send_ms;
  return ::ioctl(fd, TIOCSRS485, &settings) == 0 ? 0 : errno;
}

bool is_pseudo_terminal(int fd) noexcept {
  constexpr unsigned int kFirstMajor = 136;  // Linux: Unix98 pseudo-terminal slaves, 136 to 143
  constexpr unsigned int kLastMajor = 143;
  struct stat status {};
  return ::fstat(fd, &status) == 0 && S_ISCHR(status.st_mode) && ::major(status.st_rdev) >= kFirstMajor &&
         ::major(status.st_rdev) <= kLastMajor;
}

int set_exclusive(int fd, Exclusive exclusive) noexcept {
  return ::ioctl(fd, exclusive == Exclusive::On ? TIOCEXCL : TIOCNXCL) == 0 ? 0 : errno;
}

void flush_input(int fd) noexcept {
  ::ioctl(fd, TCFLSH, TCIFLUSH);
}

void flush_output(int fd) noexcept {
  ::ioctl(fd, TCFLSH, TCOFLUSH);
}

namespace {

constexpr std::uint32_t kRs485DelayMaxMs = 1000;

std::string line_complaint(const SerialLine& line) {
  if (!is_line_rate(line.baud)) {
    return std::to_string(line.baud) + " baud is not within 50 to 12000000";
  }
  if (line.format.data_bits != 7 && line.format.data_bits != 8) {
    return std::to_string(line.format.data_bits) + " data bits: only 7 or 8 are possible";
  }
  if (line.format.stop_bits != 1 && line.format.stop_bits != 2) {
    return std::to_string(line.format.stop_bits) + " stop bits: only 1 or 2 are possible";
  }
  return {};
}

}  // namespace

std::string complaint(const SerialConfig& config) {
  const bool is_path = !config.path.empty() && config.path.front() == '/' &&
                       config.path.size() <= kDeviceNameMax && config.path.find('\0') == std::string::npos;
  if (!is_path) {
    return "the path must start with / and have at most " + std::to_string(kDeviceNameMax) + " characters";
  }
  if (config.rs485 &&
      std::max(config.rs485->delay_before_send_ms, config.rs485->delay_after_send_ms) > kRs485DelayMaxMs) {
    return "an RS-485 delay is above " + std::to_string(kRs485DelayMaxMs) + " ms";
  }
  if (!is_valid(config.reopen)) {
    return std::string(kReopenRule);
  }
  return line_complaint(config.line);
}

}  // namespace slamsensor::hal
