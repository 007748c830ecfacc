#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace slamsensor::firmware {

/// How the size of an array member is given.
enum class LcmArray : std::uint8_t { Fixed, ByMember };

/// One member of an LCM type whose members are all primitive: its name, its primitive type ("int64_t",
/// "byte", ...) and, for a one-dimensional array, its size as text (a number or the name of the member that
/// holds it).
struct LcmMember {
  std::string_view name;
  std::string_view type;
  std::string_view size;  ///< empty: not an array
  LcmArray array = LcmArray::Fixed;
};

namespace lcm_detail {

constexpr std::uint64_t step(std::uint64_t value, std::uint8_t c) noexcept {
  const auto carried = static_cast<std::uint64_t>(static_cast<std::int64_t>(value) >> 55);
  // The generator adds a signed character; all of ours are ASCII.
  return ((value << 8U) ^ carried) + c;
}

constexpr std::uint64_t step(std::uint64_t value, std::string_view text) noexcept {
  value = step(value, static_cast<std::uint8_t>(text.size()));
  for (const char c : text) {
    value = step(value, static_cast<std::uint8_t>(c));
  }
  return value;
}

}  // namespace lcm_detail

/// The eight bytes, most significant first, that a message of the type with these members begins with
/// (lcm-gen 1.3.1).
constexpr std::uint64_t lcm_fingerprint(std::initializer_list<LcmMember> members) noexcept {
  std::uint64_t value = 0x12345678;
  for (const LcmMember& member : members) {
    value = lcm_detail::step(value, member.name);
    value = lcm_detail::step(value, member.type);
    const bool is_array = !member.size.empty();
    value = lcm_detail::step(value, static_cast<std::uint8_t>(is_array ? 1 : 0));
    if (is_array) {
      value = lcm_detail::step(value, static_cast<std::uint8_t>(member.array == LcmArray::ByMember ? 1 : 0));
      value = lcm_detail::step(value, member.size);
    }
  }
  return (value << 1U) | (value >> 63U);
}

}  // namespace slamsensor::firmware
