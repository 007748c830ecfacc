#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// Three bytes of LZF stand for at most 264: nothing expands by more than this.
inline constexpr std::size_t kLzfExpansionMax = 88;

/// The bytes that `packed` stands for in the LZF format (Marc Lehmann's LibLZF, the packing of compressed PCD
/// files). Nothing when they are not exactly `size_bytes`, or when `packed` ends within a token or refers to
/// before its start; `size_bytes` beyond what `packed` could expand to is refused before it is allocated.
[[nodiscard]] std::optional<std::vector<char>> unpack_lzf(std::string_view packed, std::size_t size_bytes);

}  // namespace slamsensor::tools
