#include "firmware/store/map_names.hpp"

#include "firmware/store/map_text.hpp"
#include "firmware/store/store_io.hpp"

#include <cerrno>

namespace slamsensor::firmware {
namespace {

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
