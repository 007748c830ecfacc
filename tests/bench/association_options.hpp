#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamsensor::bench {

/// Sizes of the maps that association is measured on.
inline constexpr std::array<std::uint32_t, 3> kMapSizes{180, 1000, 10'000};

/// How much is asked; the lists are per map size.
struct AssociationOptions {
  std::array<std::size_t, 3> queries{1000, 300, 100};
  std::array<std::size_t, 3> foreign_queries{3000, 1000, 200};
  std::size_t peer_queries = 100;
  double peer_seconds = 60.0;  ///< CPU time after which a peer is given no further query
};

/// Takes --queries=A,B,C, --foreign-queries=A,B,C, --peer-queries=N and --peer-seconds=S out of the
/// arguments; what is left is for Google Benchmark. A value that is no number ends the program with a
/// message.
[[nodiscard]] AssociationOptions take_options(int& argc, char** argv);

}  // namespace slamsensor::bench
