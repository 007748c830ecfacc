#pragma once

#include "tools/spy/lcm_packet.hpp"

#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

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

  /// The message that `packet` completes. `sender` tells senders apart.
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

}  // namespace slamsensor::tools
