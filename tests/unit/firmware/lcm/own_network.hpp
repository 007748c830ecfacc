#pragma once

#include <arpa/inet.h>
#include <functional>
#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sched.h>
#include <string>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace slamsensor::tests {

/// Runs `body` on a thread that has a network of its own, without any interface that is up. False when that
/// is not allowed here (it takes CAP_SYS_ADMIN).
inline bool in_own_network(const std::function<void()>& body) {
  bool allowed = false;
  std::thread([&] {
    allowed = ::unshare(CLONE_NEWNET) == 0;
    if (allowed) {
      body();
    }
  }).join();
  return allowed;
}

/// The loopback interface of the calling thread's network is up and multicast finds its way to it.
inline bool open_multicast_route() {
  const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
  ifreq up{};
  std::string("lo").copy(up.ifr_name, IFNAMSIZ - 1);
  up.ifr_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK | IFF_MULTICAST;
  bool done = ::ioctl(fd, SIOCSIFFLAGS, &up) == 0;
  rtentry route{};
  std::string device = "lo";
  const auto set = [](sockaddr& place, const char* address) {
    auto& in = reinterpret_cast<sockaddr_in&>(place);
    in.sin_family = AF_INET;
    in.sin_addr.s_addr = ::inet_addr(address);
  };
  set(route.rt_dst, "224.0.0.0");
  set(route.rt_genmask, "240.0.0.0");
  route.rt_flags = RTF_UP;
  route.rt_dev = device.data();
  done = done && ::ioctl(fd, SIOCADDRT, &route) == 0;
  ::close(fd);
  return done;
}

}  // namespace slamsensor::tests
