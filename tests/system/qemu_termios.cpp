// qemu-user 7.2 does not know the requests TCGETS2 and TCSETS2, which every Linux has. Preloaded into a
// program that it runs, this answers them by TCGETS and TCSETS, at the rates that have a name. For
// tests/system/arm64 alone.
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

struct Rate {
  tcflag_t code;
  speed_t baud;
};
constexpr Rate kRates[] = {{B9600, 9600},     {B19200, 19200},   {B38400, 38400},
                           {B57600, 57600},   {B115200, 115200}, {B230400, 230400},
                           {B460800, 460800}, {B921600, 921600}, {B1000000, 1000000}};

int get(int fd, termios2& settings) {
  termios plain{};
  if (syscall(SYS_ioctl, fd, TCGETS, &plain) != 0) {
    return -1;
  }
  std::memcpy(&settings, &plain, sizeof plain);
  for (const Rate& rate : kRates) {
    if ((plain.c_cflag & CBAUD) == rate.code) {
      settings.c_ispeed = settings.c_ospeed = rate.baud;
    }
  }
  return 0;
}

int set(int fd, const termios2& settings) {
  termios plain{};
  std::memcpy(&plain, &settings, sizeof plain);
  if ((settings.c_cflag & CBAUD) != BOTHER) {  // the rate is the one that has this name
    return static_cast<int>(syscall(SYS_ioctl, fd, TCSETS, &plain));
  }
  plain.c_cflag &= ~static_cast<tcflag_t>(CBAUD | (CBAUD << IBSHIFT));
  for (const Rate& rate : kRates) {
    if (settings.c_ospeed == rate.baud) {
      plain.c_cflag |= rate.code;
      return static_cast<int>(syscall(SYS_ioctl, fd, TCSETS, &plain));
    }
  }
  errno = EINVAL;
  return -1;
}

// A program of this machine that the program starts has no use for it.
[[gnu::constructor]] void forget_preload() {
  unsetenv("LD_PRELOAD");
}

}  // namespace

extern "C" int ioctl(int fd, unsigned long request, ...) {
  std::va_list rest;
  va_start(rest, request);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  const auto number = static_cast<unsigned int>(request);
  if (number == static_cast<unsigned int>(TCGETS2)) {
    return get(fd, *static_cast<termios2*>(argument));
  }
  if (number == static_cast<unsigned int>(TCSETS2)) {
    return set(fd, *static_cast<const termios2*>(argument));
  }
  return static_cast<int>(syscall(SYS_ioctl, fd, request, argument));
}
