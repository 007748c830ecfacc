#pragma once

#include "firmware/lcm/lcm_url.hpp"
#include "tools/spy/lcm_reassembler.hpp"

#include <tl/expected.hpp>

#include <array>
#include <memory>
#include <string>

namespace slamsensor::tools {

/// Hears every LCM message of a multicast group. Its own code, because the receiver of liblcm 1.3.1 writes
/// beyond its buffer when fragments lie about their place.
class LcmReceiver {
 public:
  /// Joins the group of `url`; the error says why it cannot and what to do.
  [[nodiscard]] static tl::expected<LcmReceiver, std::string> open(const firmware::LcmUrl& url);

  LcmReceiver(LcmReceiver&& other) noexcept;
  LcmReceiver& operator=(LcmReceiver&&) = delete;
  LcmReceiver(const LcmReceiver&) = delete;
  LcmReceiver& operator=(const LcmReceiver&) = delete;
  ~LcmReceiver();

  /// For poll(): readable when `next` may have something.
  [[nodiscard]] int fd() const noexcept { return fd_; }

  /// The next whole message that has arrived; none when there is none. Never waits.
  [[nodiscard]] std::optional<LcmMessageView> next();

  /// Datagrams that were no packets of LCM.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return reassembler_.dropped(); }

 private:
  explicit LcmReceiver(int fd) : fd_(fd), datagram_(std::make_unique<Datagram>()) {}
  using Datagram = std::array<std::uint8_t, 65'536>;

  int fd_;
  std::unique_ptr<Datagram> datagram_;
  LcmReassembler reassembler_;
  std::uint64_t refused_ = 0;
};

}  // namespace slamsensor::tools
