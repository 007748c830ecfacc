#include "firmware/store/map_names.hpp"

#include "firmware/store/map_file.hpp"
#include "firmware/store/store_io.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>

namespace slamsensor::firmware {
namespace {

constexpr std::int64_t kUtcEnd = 253'402'300'800;  // 10000-01-01
constexpr std::size_t kPrintableMax = 32;

struct Utc {
  int year, month, day, hour, minute, second;
};

Utc utc_of(std::int64_t seconds) {
  using namespace std::chrono;  // NOLINT(google-build-using-namespace): the calendar
  const sys_seconds time{std::chrono::seconds(std::clamp<std::int64_t>(seconds, 0, kUtcEnd - 1))};
  const sys_days day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss<std::chrono::seconds> clock(time - day);
  return {int(date.year()),
          static_cast<int>(unsigned(date.month())),
          static_cast<int>(unsigned(date.day())),
          static_cast<int>(clock.hours().count()),
          static_cast<int>(clock.minutes().count()),
          static_cast<int>(clock.seconds().count())};
}

std::string formatted(const char* format, std::int64_t seconds) {
  const Utc t = utc_of(seconds);
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, t.year, t.month, t.day, t.hour, t.minute, t.second);
  return text.data();
}

bool is_name_character(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

constexpr std::string_view kSuffix = ".slammap";
constexpr std::string_view kPrevious = ".1";
constexpr std::string_view kTemporary = ".tmp";
constexpr std::string_view kBad = ".bad-";
constexpr int kBadNamesMax = 99;

std::optional<MapFileRole> role_of(std::string_view ending) {
  if (ending.empty()) {
    return MapFileRole::Current;
  }
  if (ending == kPrevious) {
    return MapFileRole::Previous;
  }
  if (ending == kTemporary || ending == ".1.tmp") {
    return MapFileRole::Temporary;
  }
  if (ending.starts_with(kBad)) {
    return MapFileRole::SetAside;
  }
  return std::nullopt;
}

}  // namespace

bool is_map_name(std::string_view name) {
  return !name.empty() && name.size() <= kMapNameMax &&
         std::all_of(name.begin(), name.end(), is_name_character);
}

bool is_utc(std::int64_t seconds) {
  return seconds >= 0 && seconds < kUtcEnd;
}

std::string utc_text(std::int64_t seconds) {
  return formatted("%04d-%02d-%02dT%02d:%02d:%02dZ", seconds);
}

std::string utc_name(std::int64_t seconds) {
  return formatted("%04d%02d%02dT%02d%02d%02dZ", seconds);
}

std::string printable_bytes(std::span<const std::uint8_t> bytes) {
  std::string text = "\"";
  for (const std::uint8_t byte : bytes.first(std::min(bytes.size(), kPrintableMax))) {
    if (byte >= ' ' && byte <= '~') {
      text += static_cast<char>(byte);
    } else {
      std::array<char, 8> escaped{};
      std::snprintf(escaped.data(), escaped.size(), "\\x%02X", byte);
      text += escaped.data();
    }
  }
  return text + (bytes.size() > kPrintableMax ? "\"..." : "\"");
}

std::string printable_bytes(std::string_view text) {
  return printable_bytes(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

MapPaths paths_of(const std::filesystem::path& folder, std::string_view name) {
  const std::string current = (folder / name).string().append(kSuffix);
  const std::string previous = current + std::string(kPrevious);
  return {current, previous, current + std::string(kTemporary), previous + std::string(kTemporary)};
}

std::optional<MapFileName> parse_file_name(std::string_view file) {
  const std::size_t end = file.find('.');
  if (end == std::string_view::npos || !is_map_name(file.substr(0, end)) ||
      !file.substr(end).starts_with(kSuffix)) {
    return std::nullopt;
  }
  const std::optional<MapFileRole> role = role_of(file.substr(end + kSuffix.size()));
  if (!role) {
    return std::nullopt;
  }
  return MapFileName{std::string(file.substr(0, end)), *role};
}

std::optional<std::filesystem::path> free_bad_path(const MapPaths& paths, std::int64_t now_utc_s) {
  const std::string first = paths.current.string() + std::string(kBad) + utc_name(now_utc_s);
  std::string candidate = first;
  for (int number = 2; number <= kBadNamesMax + 1; ++number) {
    if (const auto there = identify(candidate); !there && there.error().error == ENOENT) {
      return candidate;
    }
    candidate = first + '-' + std::to_string(number);
  }
  return std::nullopt;
}

}  // namespace slamsensor::firmware
