#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamsensor::core {

/// Where an edge stands when not all of a graph's edges fit; unsigned, lower stays longer. No two edges share
/// a rank.
__extension__ typedef unsigned __int128 EdgeRank;

/// Finds the rank below which exactly `room` edges lie, without storing edges: all ranks are shown to it in
/// each of several passes, and a pass settles the next 11 bits of the limit from the top (a radix selection).
class EdgeLimit {
 public:
  /// Ranks have `rank_bits` bits (1 to 128), and there are more than `room` of them.
  EdgeLimit(std::uint32_t rank_bits, std::uint64_t room) noexcept : open_bits_(rank_bits), room_(room) {}

  /// False while another pass is needed.
  [[nodiscard]] bool settled() const noexcept { return settled_; }

  /// Counts an edge of the running pass; every pass shows the same ranks, in any order.
  void show(EdgeRank rank) noexcept;

  void end_pass() noexcept;

  /// The number of ranks per pass.
  [[nodiscard]] std::uint64_t total() const noexcept { return total_; }

  /// Once settled: whether `rank` is among the `room` lowest.
  [[nodiscard]] bool admits(EdgeRank rank) const noexcept { return rank < limit_; }

 private:
  static constexpr std::uint32_t kDigitBits = 11;

  std::array<std::uint64_t, std::size_t{1} << kDigitBits> counts_{};  // edges per value of the next bits
  EdgeRank limit_ = 0;  // its upper bits are settled, the `open_bits_` below are zero
  std::uint32_t open_bits_;
  std::uint64_t room_;  // how many of the ranks that agree with the settled bits may stay
  std::uint64_t total_ = 0;
  std::uint64_t shown_ = 0;
  bool settled_ = false;
};

}  // namespace slamsensor::core
