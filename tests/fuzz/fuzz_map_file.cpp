#include "firmware/store/map_file.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

namespace {

using namespace slamsensor;  // NOLINT(google-build-using-namespace): a program of one file

using Bytes = std::vector<std::uint8_t>;

std::uint64_t number_at(std::span<const std::uint8_t> bytes, std::size_t place) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::uint64_t{bytes[place + i]} << (8 * i);
  }
  return value;
}

void put(Bytes& bytes, std::size_t place, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes[place + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

/// Makes size and checksums hold as far as the lengths of the sections lead, so that what is behind them is
/// reached.
void seal(Bytes& bytes) {
  if (bytes.size() < firmware::kMapPrefixBytes) {
    return;
  }
  std::copy(firmware::kMapMagic.begin(), firmware::kMapMagic.end(), bytes.begin());
  put(bytes, 16, bytes.size(), 8);
  put(bytes, 24, firmware::crc32_of(std::span(bytes).first(24)), 4);
  std::size_t begin = firmware::kMapPrefixBytes;
  while (bytes.size() - begin >= firmware::kSectionHeadBytes) {
    const std::uint64_t payload = number_at(bytes, begin + 4) * number_at(bytes, begin + 8);
    const std::size_t data = begin + firmware::kSectionHeadBytes;
    if (payload > bytes.size() - data) {
      return;
    }
    const auto size = static_cast<std::size_t>(payload);
    const std::span<const std::uint8_t> all(bytes);
    put(bytes, begin + 12, firmware::crc32_of(all.subspan(begin, 12), all.subspan(data, size)), 4);
    begin = data + size;
  }
}

void check(std::span<const std::uint8_t> bytes) {
  core::Capacities capacities;
  capacities.map_landmarks = 1000;
  capacities.path_poses = 1000;
  const auto map = firmware::decode_map(bytes, capacities);
  if (!map) {
    const std::string& message = map.error().message;
    if (message.empty() ||
        !std::all_of(message.begin(), message.end(), [](char c) { return c >= ' ' && c <= '~'; })) {
      std::abort();
    }
    return;
  }
  if (!core::check_map(map->state(), capacities).ok()) {
    std::abort();
  }
  const Bytes again = firmware::encode_map(map->about, map->state());
  if (number_at(bytes, 8) == firmware::kMapVersion &&
      !std::equal(again.begin(), again.end(), bytes.begin(), bytes.end())) {
    std::abort();
  }
}

}  // namespace

/// Any bytes are either refused with a message of one line, or give a map without a flaw; written again, it
/// is the same bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check({data, size});
  Bytes sealed(data, data + size);
  seal(sealed);
  check(sealed);
  return 0;
}
