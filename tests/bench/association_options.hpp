#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamsensor::bench {

/// Sizes of the maps that association is measured on.
inline constexpr std::array<std::uint32_t, 5> kMapSizes{180, 1'000, 10'000, 100'000, 1'000'000};

/// How much is asked.
struct AssociationOptions {
  std::array<std::size_t, 5> queries{1000, 1000, 300, 200, 100};  ///< of each task, per map size
  std::size_t paper_queries = 30;  ///< of the paper's search, which takes up to seconds for one
  std::size_t peer_queries = 100;
  double peer_seconds = 60.0;  ///< CPU time after which a peer is given no further query
};

/// Takes --queries=A,B,C,D,E, --paper-queries=N, --peer-queries=N and --peer-seconds=S out of the arguments;
/// what is left is for Google Benchmark. A value that is no number ends the program with a message.
[[nodiscard]] AssociationOptions take_options(int& argc, char** argv);

}  // namespace slamsensor::bench
