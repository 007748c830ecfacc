#include "tools/input/scan_files.hpp"

#include "tools/input/file.hpp"
#include "tools/input/text.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <system_error>
#include <utility>

namespace slamsensor::tools {
namespace {

using Path = std::filesystem::path;
using Status = tl::expected<void, InputError>;

constexpr std::size_t kCsvHeaderBytesMax = std::size_t{64} * 1024;

std::string lower_extension(const Path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return extension;
}

bool names_column(std::string_view header, std::string_view column) {
  for (;;) {
    const std::size_t comma = header.find(',');
    if (trim(header.substr(0, comma)) == column) {
      return true;
    }
    if (comma == std::string_view::npos) {
      return false;
    }
    header.remove_prefix(comma + 1);
  }
}

tl::expected<CsvKind, InputError> kind_of_file(const Path& path) {
  return read_file(path, kCsvHeaderBytesMax).map([](const std::string& start) { return csv_kind(start); });
}

std::optional<ScanFileKind> scan_kind(CsvKind kind) {
  switch (kind) {
    case CsvKind::Readings:
      return ScanFileKind::Readings;
    case CsvKind::Landmarks:
      return ScanFileKind::Landmarks;
    case CsvKind::Empty:
    case CsvKind::Map:
    case CsvKind::Other:
      break;
  }
  return std::nullopt;
}

tl::unexpected<InputError> refuse_csv(const Path& path, CsvKind kind) {
  if (kind == CsvKind::Empty) {
    return refuse(path.string(), "is empty; it must start with a line that names its columns");
  }
  return refuse(
      path.string(),
      std::string(kind == CsvKind::Map ? "is a map, not scans" : "names no columns of scans") +
          "; readings have pan_deg,tilt_deg,range_m and landmark lists scan,x_m,y_m[,diameter_m[,weight]]");
}

Status add_csv(const Path& path, bool from_folder, ScanFiles& files) {
  const auto kind = kind_of_file(path);
  if (!kind) {
    return tl::unexpected(kind.error());
  }
  if (const auto scans = scan_kind(*kind)) {
    files.scans.push_back({path, *scans});
    return {};
  }
  if (!from_folder || *kind == CsvKind::Empty) {
    return refuse_csv(path, *kind);
  }
  files.ignored.push_back(path);
  return {};
}

Status add_file(const Path& path, ScanFiles& files) {
  const std::string extension = lower_extension(path);
  if (extension == ".pcd") {
    files.scans.push_back({path, ScanFileKind::Cloud});
    return {};
  }
  if (extension == ".csv") {
    return add_csv(path, false, files);
  }
  return refuse(
      path.string(),
      "ends in neither .pcd nor .csv; scans are point clouds (.pcd), readings or landmarks (.csv), or "
      "a recording, which begins as an LCM event log does");
}

// The regular .pcd and .csv files of a folder by name, so that the order does not depend on the file system.
tl::expected<std::vector<Path>, InputError> list_folder(const Path& folder) {
  std::error_code error;
  std::vector<Path> paths;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const Path& path = entry->path();
    const std::string extension = lower_extension(path);
    std::error_code ignored;
    const bool hidden = path.filename().string().starts_with('.');
    if (!hidden && (extension == ".pcd" || extension == ".csv") && entry->is_regular_file(ignored)) {
      paths.push_back(path);
    }
  }
  if (error) {
    return refuse(folder.string(), "cannot be listed: " + error.message());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

Status add_folder(const Path& folder, ScanFiles& files) {
  const auto paths = list_folder(folder);
  if (!paths) {
    return tl::unexpected(paths.error());
  }
  const std::size_t before = files.scans.size();
  for (const Path& path : *paths) {
    if (lower_extension(path) == ".pcd") {
      files.scans.push_back({path, ScanFileKind::Cloud});
    } else if (auto added = add_csv(path, true, files); !added) {
      return added;
    }
  }
  if (files.scans.size() == before) {
    return refuse(folder.string(),
                  "holds no scans; give a folder with .pcd clouds, or .csv readings or landmarks");
  }
  return {};
}

Status add_input(const Path& path, ScanFiles& files) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) {
    return add_folder(path, files);
  }
  if (status.type() == std::filesystem::file_type::not_found) {
    return refuse(path.string(), "does not exist; check the path");
  }
  if (!std::filesystem::status_known(status)) {
    return refuse(path.string(), "cannot be opened: " + error.message());
  }
  return add_file(path, files);
}

}  // namespace

CsvKind csv_kind(std::string_view text) {
  LineReader lines(text);
  if (!lines.next()) {
    return CsvKind::Empty;
  }
  const std::string_view header = lines.line();
  for (const std::string_view column : {"pan_deg", "tilt_deg", "range_m"}) {
    if (names_column(header, column)) {
      return CsvKind::Readings;
    }
  }
  if (!names_column(header, "x_m")) {
    return CsvKind::Other;
  }
  if (names_column(header, "scan")) {
    return CsvKind::Landmarks;
  }
  return names_column(header, "id") ? CsvKind::Map : CsvKind::Other;
}

std::optional<std::int64_t> scan_number(const Path& path) {
  constexpr std::string_view kDigits = "0123456789";
  const std::string stem = path.stem().string();
  const std::size_t last = stem.find_last_of(kDigits);
  if (last == std::string::npos) {
    return std::nullopt;
  }
  const std::size_t before = stem.find_last_not_of(kDigits, last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  return parse_integer(std::string_view(stem).substr(first, last - first + 1));
}

tl::expected<ScanFiles, InputError> find_scan_files(std::span<const Path> inputs) {
  if (inputs.empty()) {
    return tl::unexpected(InputError{"no input given; name files or folders of scans (.pcd, .csv)"});
  }
  ScanFiles files;
  for (const Path& path : inputs) {
    if (auto added = add_input(path, files); !added) {
      return tl::unexpected(std::move(added.error()));
    }
  }
  return files;
}

}  // namespace slamsensor::tools
