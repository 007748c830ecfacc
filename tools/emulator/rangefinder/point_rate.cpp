#include "tools/emulator/rangefinder/point_rate.hpp"

#include <algorithm>
#include <array>

namespace slamsensor::tools {

double lds70a_rate_max_hz(std::uint32_t baud, PointCoding coding, std::size_t bytes) {
  struct Row {
    std::uint32_t baud;
    double binary;
    std::array<double, 4> decimal;  // of 11, 16, 17 and 22 bytes
  };
  constexpr std::array<Row, 7> kRows = {{{9600, 470, {80, 50, 48, 40}},
                                         {19'200, 940, {160, 100, 90, 75}},
                                         {115200, 5750, {1000, 700, 660, 480}},
                                         {230'400, 11'600, {2000, 1400, 1300, 980}},
                                         {460'800, 23'200, {4100, 2750, 2500, 1850}},
                                         {921'600, 40'000, {7300, 4750, 4350, 3300}},
                                         {2'000'000, 40'000, {12'200, 7850, 6480, 5000}}}};
  const auto* const row = std::ranges::find_if(kRows, [baud](const Row& each) { return each.baud >= baud; });
  const Row& found = row != kRows.end() ? *row : kRows.back();
  if (!is_text(coding)) {
    return found.binary * 2.0 / static_cast<double>(bytes);
  }
  constexpr std::array<std::size_t, 4> kBytes = {11, 16, 17, 22};
  for (std::size_t i = 0; i < kBytes.size(); ++i) {
    if (bytes <= kBytes[i]) {
      return found.decimal[i];
    }
  }
  return found.decimal.back();
}

}  // namespace slamsensor::tools
