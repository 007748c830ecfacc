#pragma once

#include "firmware/lcm/lcm_sink.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// Longest message that is put together from fragments; larger ones are refused.
inline constexpr std::size_t kLcmMessageMax = 4U << 20U;

/// One datagram of LCM (LCM UDP multicast protocol): a whole message, or a fragment of one.
struct LcmPacket {
  std::uint32_t sequence = 0;
  std::string_view channel;  ///< 1 to 63 characters; empty in all fragments but the first
  std::span<const std::uint8_t> data;
  std::uint32_t message_bytes = 0;  ///< of the whole message
  std::uint32_t offset = 0;    ///< of `data` in it; offset + size of data <= message_bytes <= kLcmMessageMax
  std::uint16_t fragment = 0;  ///< below `fragments`
  std::uint16_t fragments = 1;
};

/// The packet in `datagram`, with views into it; none when its bytes are not one or its numbers disagree.
[[nodiscard]] std::optional<LcmPacket> parse_lcm_packet(std::span<const std::uint8_t> datagram) noexcept;

/// A whole message; the views last until the next call of who gave it.
struct LcmMessageView {
  std::string_view channel;
  std::span<const std::uint8_t> bytes;
};

/// Puts messages together from packets, in whatever order the fragments come, from several senders at once.
/// Holds at most kSetsMax unfinished messages and kBytesMax of their bytes: the oldest give way. What a head
/// promises takes no memory, only what comes does.
class LcmReassembler {
 public:
  static constexpr std::size_t kSetsMax = 32;
  static constexpr std::size_t kBytesMax = 4 * kLcmMessageMax;

  /// The message that `packet` completes. `sender` distinguishes senders.
  [[nodiscard]] std::optional<LcmMessageView> push(std::uint64_t sender, const LcmPacket& packet);

  /// Unfinished messages that had to give way, or whose fragments disagreed.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }
  /// Bytes held of unfinished messages.
  [[nodiscard]] std::size_t held_bytes() const noexcept { return held_; }

 private:
  struct Piece {
    std::uint32_t offset = 0;
    std::vector<std::uint8_t> bytes;
  };
  struct Set {
    std::uint64_t sender = 0;
    std::uint32_t sequence = 0;
    std::string channel;
    std::uint32_t message_bytes = 0;
    std::uint16_t fragments = 0;
    std::map<std::uint16_t, Piece> pieces;  ///< by the number of the fragment
    std::size_t bytes = 0;                  ///< in the pieces
  };
  using Sets = std::list<Set>;  // oldest first

  [[nodiscard]] Sets::iterator find_or_begin(std::uint64_t sender, const LcmPacket& packet);
  void keep_within_bounds();
  void forget(Sets::iterator set);
  void drop(Sets::iterator set);
  void assemble(const Set& set);

  Sets sets_;
  std::size_t held_ = 0;
  std::uint64_t dropped_ = 0;
  std::string channel_;  ///< of the message given last, and its bytes
  std::vector<std::uint8_t> message_;
};

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
