#include "firmware/recording/map_order.hpp"

#include <array>
#include <charconv>

namespace slamsensor::firmware {
namespace {

constexpr std::array<std::string_view, 4> kKinds = {"reset", "freeze", "unfreeze", "load"};

}  // namespace

std::string text_of(const MapOrder& order) {
  return std::string(kKinds[static_cast<std::size_t>(order.kind)]) + ' ' + std::to_string(order.scan);
}

std::optional<MapOrder> parse_map_order(std::string_view text) noexcept {
  const std::size_t space = text.find(' ');
  for (std::size_t kind = 0; kind < kKinds.size() && space != std::string_view::npos; ++kind) {
    if (text.substr(0, space) != kKinds[kind]) {
      continue;
    }
    MapOrder order{static_cast<MapCommand>(kind)};
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + space + 1, end, order.scan);
    return error == std::errc() && rest == end ? std::optional(order) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace slamsensor::firmware
