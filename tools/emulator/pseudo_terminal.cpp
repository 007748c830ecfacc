#include "tools/emulator/pseudo_terminal.hpp"

// termios2, for rates of any number; it cannot stand in one file with <termios.h>.
#include <array>
#include <asm/termbits.h>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace slamsensor::tools {
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

/// Only from its first opening on does a terminal tell whether a host is there.
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

}  // namespace slamsensor::tools
