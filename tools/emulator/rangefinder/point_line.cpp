#include "tools/emulator/rangefinder/point_line.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace slamsensor::tools {

std::string upper(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(' '), text.size());
  const std::size_t end = text.find_last_not_of(' ');
  return text.substr(begin, end == std::string_view::npos ? 0 : end + 1 - begin);
}

std::optional<std::vector<double>> numbers_in(std::string_view text) {
  const std::string copy(text);
  const char* at = copy.c_str();
  std::vector<double> numbers;
  while (*at != '\0') {
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end == at || !std::isfinite(number)) {
      return std::nullopt;
    }
    numbers.push_back(number);
    at = end;
    while (*at == ' ') {
      ++at;
    }
  }
  return numbers;
}

}  // namespace slamsensor::tools
