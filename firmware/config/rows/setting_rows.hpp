#pragma once

#include "firmware/config/setting.hpp"

#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

namespace slamsensor::firmware {

/// Sections that belong together, with their keys in the same order. Both live as long as the program.
struct SettingRows {
  std::span<const Section> sections;
  std::span<const Setting> settings;
};

[[nodiscard]] SettingRows head_rows();
[[nodiscard]] SettingRows rangefinder_rows();
[[nodiscard]] SettingRows method_rows();
[[nodiscard]] SettingRows daemon_rows();

}  // namespace slamsensor::firmware

/// What a row of the table of settings is made with: each function takes the chain of members that leads from
/// a Config to the value.
namespace slamsensor::firmware::rows {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Names of hal::SampleTiming.
inline constexpr std::string_view kClockTimings[] = {"periodic", "as_arrived"};

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// Follows a chain of members for writing; an optional on the way is filled when it is empty.
template <auto kFirst, auto... kRest, typename Struct>
auto* write_path(Struct& object) {
  auto& member = object.*kFirst;
  if constexpr (sizeof...(kRest) == 0) {
    return &member;
  } else if constexpr (IsOptional<std::remove_cvref_t<decltype(member)>>::value) {
    return write_path<kRest...>(member ? *member : member.emplace());
  } else {
    return write_path<kRest...>(member);
  }
}

/// Follows a chain of members for reading; null when an optional on the way is empty.
template <auto kFirst, auto... kRest, typename Struct>
auto read_path(const Struct& object) {
  const auto& member = object.*kFirst;
  if constexpr (sizeof...(kRest) == 0) {
    return &member;
  } else if constexpr (IsOptional<std::remove_cvref_t<decltype(member)>>::value) {
    using Pointer = decltype(read_path<kRest...>(*member));
    return member ? read_path<kRest...>(*member) : Pointer{nullptr};
  } else {
    return read_path<kRest...>(member);
  }
}

template <auto... kPath>
using Stored = std::remove_pointer_t<decltype(write_path<kPath...>(std::declval<Config&>()))>;

template <typename T, auto... kPath>
constexpr Member<T> member_at() {
  return {[](Config& config) -> T* { return write_path<kPath...>(config); },
          [](const Config& config) -> const T* { return read_path<kPath...>(config); }};
}

/// For a value that is stored as another type: cast both ways.
template <typename T, auto... kPath>
constexpr Access<T> cast_at() {
  return {[](Config& config, const T& value) {
            *write_path<kPath...>(config) = static_cast<Stored<kPath...>>(value);
          },
          [](const Config& config) -> std::optional<T> {
            const auto* const value = read_path<kPath...>(config);
            return value == nullptr ? std::nullopt : std::optional<T>(static_cast<T>(*value));
          }};
}

template <auto... kPath>
constexpr RealSetting real(double min, double max) {
  return {member_at<double, kPath...>(), min, max, 1.0};
}

/// Degrees in the file, radians in the program.
template <auto... kPath>
constexpr RealSetting degrees(double min_deg, double max_deg) {
  return {member_at<double, kPath...>(), min_deg, max_deg, core::kDegree};
}

template <auto... kPath>
constexpr DurationSetting duration(double min_s, double max_s) {
  return {member_at<hal::Stamp, kPath...>(), min_s, max_s};
}

template <auto... kPath>
constexpr IntegerSetting integer(std::int64_t min, std::int64_t max) {
  return {.access = cast_at<std::int64_t, kPath...>(), .min = min, .max = max};
}

template <auto... kPath>
constexpr IntegerSetting hexadecimal(std::int64_t min, std::int64_t max) {
  IntegerSetting setting = integer<kPath...>(min, max);
  setting.base = NumberBase::Hexadecimal;
  return setting;
}

/// `only` is in ascending order.
template <auto... kPath>
constexpr IntegerSetting one_of(std::span<const std::uint32_t> only) {
  IntegerSetting setting = integer<kPath...>(only.front(), only.back());
  setting.only = only;
  return setting;
}

template <auto... kPath>
constexpr BooleanSetting boolean() {
  return {member_at<bool, kPath...>()};
}

template <auto... kPath>
constexpr ChoiceSetting choice(std::span<const std::string_view> names) {
  static_assert(std::is_enum_v<Stored<kPath...>>);
  return {cast_at<std::size_t, kPath...>(), names};
}

template <auto... kPath>
constexpr TextSetting text(std::span<const std::string_view> names) {
  return {member_at<std::string, kPath...>(), names};
}

template <auto... kPath>
constexpr FreeTextSetting free_text(const TextRule& rule) {
  return {cast_at<std::string, kPath...>(), &rule};
}

template <auto... kPath>
constexpr IntegerListSetting integers(std::uint32_t min, std::uint32_t max, ItemCount items) {
  return {member_at<std::vector<std::uint32_t>, kPath...>(), min, max, items};
}

template <auto... kPath>
constexpr TextListSetting texts(const TextRule& rule, ItemCount items) {
  return {cast_at<std::vector<std::string>, kPath...>(), &rule, items};
}

}  // namespace slamsensor::firmware::rows
