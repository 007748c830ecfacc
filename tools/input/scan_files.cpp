#include "tools/input/scan_files.hpp"

#include "tools/input/csv.hpp"
#include "tools/input/file.hpp"
#include "tools/input/text.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace slamsensor::tools {
namespace {

using Path = std::filesystem::path;
using Status = tl::expected<void, InputError>;

constexpr std::size_t kCsvHeaderBytesMax = std::size_t{64} * 1024;

std::string lower(std::string text) {
  for (char& c : text) {
    c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return text;
}

std::string lower_extension(const Path& path) {
  return lower(path.extension().string());
}

tl::expected<CsvKind, InputError> kind_of_file(const Path& path) {
  const auto start = read_file(path, kCsvHeaderBytesMax);
  if (!start) {
    return tl::unexpected(start.error());
  }
  if (auto checked = check_encoding(*start, path.string()); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  return csv_kind(*start);
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

std::string csv_reason(CsvKind kind) {
  if (kind == CsvKind::Empty) {
    return "is empty; it must start with a line that names its columns";
  }
  return std::string(kind == CsvKind::Map ? "is a map, not scans" : "names no columns of scans") +
         "; readings have pan_deg,tilt_deg,range_m[,roll_deg,pitch_deg] and landmark lists "
         "scan,x_m,y_m[,diameter_m[,weight]]";
}

Status add_csv(const Path& path, ScanFiles& files) {
  const auto kind = kind_of_file(path);
  if (!kind) {
    return tl::unexpected(kind.error());
  }
  const auto scans = scan_kind(*kind);
  if (!scans) {
    return refuse(path.string(), csv_reason(*kind));
  }
  files.scans.push_back({path, *scans});
  return {};
}

Status add_file(const Path& path, ScanFiles& files) {
  const std::string extension = lower_extension(path);
  if (extension == ".pcd") {
    files.scans.push_back({path, ScanFileKind::Cloud});
    return {};
  }
  if (extension == ".csv") {
    return add_csv(path, files);
  }
  return refuse(
      path.string(),
      "ends in neither .pcd nor .csv; scans are point clouds (.pcd), readings or landmarks (.csv), or "
      "a recording, which begins as an LCM event log does");
}

// All entries of a folder by name, so that the order does not depend on the file system.
tl::expected<std::vector<Path>, InputError> list_folder(const Path& folder) {
  std::error_code error;
  std::vector<Path> paths;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    paths.push_back(entry->path());
  }
  if (error) {
    return refuse(folder.string(), "cannot be listed: " + error.message());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

// Files that people keep beside scans, by their names.
bool is_companion(const Path& path) {
  constexpr std::array<std::string_view, 16> kExtensions{".tum",  ".toml", ".md",  ".svg", ".nmea", ".json",
                                                         ".yaml", ".yml",  ".png", ".jpg", ".jpeg", ".pdf",
                                                         ".html", ".py",   ".sh",  ".log"};
  const std::string stem = lower(path.stem().string());
  return stem.starts_with("readme") || stem.starts_with("license") ||
         std::find(kExtensions.begin(), kExtensions.end(), lower_extension(path)) != kExtensions.end();
}

// Why an entry of a folder is no file that may hold scans; nothing when it is one.
std::optional<NotRead> not_scans(const Path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (path.filename().string().starts_with('.')) {
    return NotRead{path, "is hidden", NotReadKind::Companion};
  }
  if (std::filesystem::is_directory(status)) {
    return NotRead{path, "is a folder in a folder; give it as an input of its own", NotReadKind::Missed};
  }
  if (!std::filesystem::is_regular_file(status)) {
    const bool is_known = std::filesystem::status_known(status) && std::filesystem::exists(status);
    return NotRead{path, is_known ? "is not a regular file" : "cannot be opened: " + error.message(),
                   NotReadKind::Missed};
  }
  const std::string extension = lower_extension(path);
  if (extension == ".pcd" || extension == ".csv") {
    return std::nullopt;
  }
  if (is_companion(path)) {
    return NotRead{path, "is not a scan by its name", NotReadKind::Companion};
  }
  return NotRead{path,
                 extension == ".lcm" ? "is a recording by its name; replay it alone"
                                     : "ends in neither .pcd nor .csv; convert it if it is a scan",
                 NotReadKind::Missed};
}

void add_csv_of_folder(const Path& path, ScanFiles& files) {
  const auto kind = kind_of_file(path);
  if (!kind) {
    const std::string prefix = path.string() + ": ";
    const std::string& message = kind.error().message;
    files.not_read.push_back(
        {path, message.starts_with(prefix) ? message.substr(prefix.size()) : message, NotReadKind::Missed});
  } else if (const auto scans = scan_kind(*kind)) {
    files.scans.push_back({path, *scans});
  } else {
    files.not_read.push_back(
        {path, csv_reason(*kind), *kind == CsvKind::Map ? NotReadKind::Companion : NotReadKind::Missed});
  }
}

tl::unexpected<InputError> refuse_folder(const Path& folder, std::span<const NotRead> not_read) {
  std::string what = "holds no scans; give a folder with .pcd clouds, or .csv readings or landmarks";
  for (const NotRead& entry : not_read) {
    what += "\n  " + entry.path.string() + ": " + entry.reason;
  }
  return refuse(folder.string(), what);
}

Status add_folder(const Path& folder, ScanFiles& files) {
  const auto paths = list_folder(folder);
  if (!paths) {
    return tl::unexpected(paths.error());
  }
  const std::size_t scans_before = files.scans.size();
  const std::size_t not_read_before = files.not_read.size();
  for (const Path& path : *paths) {
    if (auto entry = not_scans(path)) {
      files.not_read.push_back(std::move(*entry));
    } else if (lower_extension(path) == ".pcd") {
      files.scans.push_back({path, ScanFileKind::Cloud});
    } else {
      add_csv_of_folder(path, files);
    }
  }
  if (files.scans.size() == scans_before) {
    return refuse_folder(folder, std::span(files.not_read).subspan(not_read_before));
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
  const auto header = read_csv_header(lines);
  if (!header) {
    return CsvKind::Empty;
  }
  const auto names_column = [&](std::string_view column) {
    return std::find(header->columns.begin(), header->columns.end(), column) != header->columns.end();
  };
  if (names_column("pan_deg") || names_column("tilt_deg") || names_column("range_m")) {
    return CsvKind::Readings;
  }
  if (!names_column("x_m")) {
    return CsvKind::Other;
  }
  if (names_column("scan")) {
    return CsvKind::Landmarks;
  }
  return names_column("id") ? CsvKind::Map : CsvKind::Other;
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
