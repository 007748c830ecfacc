#include "tools/input/scan_source.hpp"

#include "core/limits.hpp"
#include "tools/input/csv.hpp"
#include "tools/input/pcd.hpp"
#include "tools/input/scan_names.hpp"
#include "tools/input/text_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
    case CsvKind::Fixes:
    case CsvKind::Other:
      break;
  }
  return std::nullopt;
}

std::string csv_reason(CsvKind kind) {
  if (kind == CsvKind::Empty) {
    return "is empty; it must start with a line that names its columns";
  }
  return std::string(kind == CsvKind::Map     ? "is a map, not scans"
                     : kind == CsvKind::Fixes ? "holds the fixes of an earlier run, not scans"
                                              : "names no columns of scans") +
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
    return refuse(folder.string(), "cannot be listed: " + error.message() +
                                       "; make it readable (chmod u+rx), or name its files");
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
        {path, csv_reason(*kind),
         *kind == CsvKind::Map || *kind == CsvKind::Fixes ? NotReadKind::Companion : NotReadKind::Missed});
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
    return names_column("status") ? CsvKind::Fixes : CsvKind::Landmarks;
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

namespace {

constexpr double kStepMin_rad =
    1e-5;  // a finer grid is a mistake, and would fill the memory with empty columns

// Where one scan is found: in a file of its own, or in the rows of a list.
struct Entry {
  ScanLabel label;
  std::string name;
  ScanFile file;
  std::vector<LandmarkRow> rows;  // of a list only
};

using Status = tl::expected<void, InputError>;

// A list that cannot be read goes to `refused`.
Status add_list(const ScanFile& file, const firmware::Config& config, std::vector<Entry>& entries,
                std::vector<InputError>& refused) {
  const std::string name = file.path.string();
  const auto text = read_file(file.path);
  const auto list = text ? parse_landmark_csv(*text, name)
                         : tl::expected<LandmarkList, InputError>(tl::unexpected(text.error()));
  if (!list) {
    refused.push_back(list.error());
    return {};
  }
  if (auto checked = check_landmark_columns(*list, name, config.landmark_list); !checked) {
    return checked;
  }
  auto first = list->rows.begin();
  while (first != list->rows.end()) {
    const std::int64_t number = first->scan;
    const auto last =
        std::find_if(first, list->rows.end(), [&](const LandmarkRow& row) { return row.scan != number; });
    entries.push_back({{number, std::chrono::seconds(number)},
                       name + ": scan " + std::to_string(number),
                       file,
                       {first, last}});
    first = last;
  }
  return {};
}

// The scans that have a file of their own, and which rule of their names orders them.
tl::expected<std::string, InputError> add_scans(const std::vector<ScanFile>& files,
                                                std::vector<Entry>& entries) {
  std::vector<std::filesystem::path> paths;
  for (const ScanFile& file : files) {
    paths.push_back(file.path);
  }
  auto labels = label_scans(paths);
  if (!labels) {
    return tl::unexpected(std::move(labels.error()));
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    entries.push_back({labels->labels[i], files[i].path.string(), files[i], {}});
  }
  return std::move(labels->rule);
}

// Puts the entries in the order of their times. Each number may occur once.
Status order_entries(std::vector<Entry>& entries) {
  const auto is_less = [](const Entry& a, const Entry& b) { return a.label.number < b.label.number; };
  std::stable_sort(entries.begin(), entries.end(), is_less);
  const auto same = std::adjacent_find(entries.begin(), entries.end(),
                                       [&](const Entry& a, const Entry& b) { return !is_less(a, b); });
  if (same != entries.end()) {
    return refuse(std::next(same)->name, "has the scan number " + std::to_string(same->label.number) +
                                             ", as has " + same->name + "; rename one or leave one out");
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.label.time < b.label.time; });
  return {};
}

Status check_steps(const firmware::Config& config) {
  for (const auto& [key, step_rad] :
       {std::pair("detection.bearing_step_rad", config.core.detection.bearing_step_rad),
        std::pair("point_cloud.tilt_step_rad", config.point_cloud.tilt_step_rad)}) {
    if (!std::isfinite(step_rad) || step_rad < kStepMin_rad) {
      return refuse("config", std::string(key) + " is " + shown(step_rad) + "; at least " +
                                  shown(kStepMin_rad) + " rad is needed");
    }
  }
  return {};
}

class FileScanSource final : public ScanSource {
 public:
  FileScanSource(std::vector<Entry> entries, std::vector<InputError> refused, std::vector<NotRead> not_read,
                 std::string order, const firmware::Config& config)
      : entries_(std::move(entries)),
        refused_(std::move(refused)),
        not_read_(std::move(not_read)),
        order_(std::move(order)),
        config_(config) {}

  std::size_t count() const override { return entries_.size() + refused_.size(); }

  tl::expected<std::optional<InputScan>, InputError> next() override {
    if (at_ == count()) {
      return std::optional<InputScan>();
    }
    const std::size_t place = at_++;
    if (place < refused_.size()) {
      return tl::unexpected(refused_[place]);
    }
    const Entry& entry = entries_[place - refused_.size()];
    InputScan scan;
    scan.number = entry.label.number;
    scan.time = entry.label.time;
    scan.name = entry.name;
    if (Status loaded = load(entry, scan); !loaded) {
      return tl::unexpected(std::move(loaded.error()));
    }
    return std::optional<InputScan>(std::move(scan));
  }

  std::span<const NotRead> not_read() const override { return not_read_; }
  const std::string& order() const override { return order_; }

 private:
  Status load(const Entry& entry, InputScan& scan) const {
    if (entry.file.kind == ScanFileKind::Landmarks) {
      scan.is_landmark_list = true;
      ListScan selected = select_landmarks(entry.rows, config_.landmark_list, config_.core.detection);
      scan.landmarks = std::move(selected.landmarks);
      scan.landmarks_beyond_max = selected.beyond_max;
      scan.landmarks_at_one_place = selected.at_one_place;
      return {};
    }
    const auto bytes = read_file(entry.file.path);
    if (!bytes) {
      return tl::unexpected(bytes.error());
    }
    return entry.file.kind == ScanFileKind::Cloud ? load_cloud(*bytes, scan) : load_readings(*bytes, scan);
  }

  Status load_cloud(std::string_view bytes, InputScan& scan) const {
    const auto cloud = parse_pcd(bytes, scan.name);
    if (!cloud) {
      return tl::unexpected(cloud.error());
    }
    scan.points_skipped = cloud->points_skipped;
    scan.remark = cloud->remark;
    return scanlines_of_cloud(*cloud, config_.point_cloud, config_.core.detection.bearing_step_rad, scan.name)
        .map([&](auto&& scanlines) { scan.scanlines = std::forward<decltype(scanlines)>(scanlines); });
  }

  Status load_readings(std::string_view text, InputScan& scan) const {
    return parse_readings_csv(text, scan.name, config_.scan_head.levelling).map([&](ReadingsScan&& readings) {
      scan.scanlines = std::move(readings.scanlines);
      scan.zero_ranges = readings.zero_ranges;
      scan.remark = std::move(readings.remark);
    });
  }

  std::vector<Entry> entries_;
  std::vector<InputError> refused_;  // given before all entries
  std::vector<NotRead> not_read_;
  std::string order_;
  firmware::Config config_;
  std::size_t at_ = 0;
};

}  // namespace

tl::expected<std::unique_ptr<ScanSource>, InputError> open_scans(
    std::span<const std::filesystem::path> inputs, const firmware::Config& config) {
  if (auto checked = check_steps(config); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  auto files = find_scan_files(inputs);
  if (!files) {
    return tl::unexpected(std::move(files.error()));
  }
  std::vector<Entry> entries;
  std::vector<InputError> refused;
  std::vector<ScanFile> own_files;
  for (const ScanFile& file : files->scans) {
    if (file.kind != ScanFileKind::Landmarks) {
      own_files.push_back(file);
    } else if (auto added = add_list(file, config, entries, refused); !added) {
      return tl::unexpected(std::move(added.error()));
    }
  }
  auto order = add_scans(own_files, entries);
  if (!order) {
    return tl::unexpected(std::move(order.error()));
  }
  if (auto ordered = order_entries(entries); !ordered) {
    return tl::unexpected(std::move(ordered.error()));
  }
  return std::make_unique<FileScanSource>(std::move(entries), std::move(refused), std::move(files->not_read),
                                          std::move(*order), config);
}

void LeftOut::see(const InputScan& scan) {
  see_list(scan.landmarks.size(), scan.landmarks_beyond_max);
  landmarks_at_one_place += scan.landmarks_at_one_place;
  zero_ranges += scan.zero_ranges;
}

void LeftOut::see_list(std::size_t used, std::size_t beyond_max) {
  if (beyond_max > 0) {
    landmarks_beyond_max += beyond_max;
    ++scans_beyond_max;
    landmarks_most = std::max(landmarks_most, used + beyond_max);
  }
}

void LeftOut::add(const LeftOut& other) {
  landmarks_beyond_max += other.landmarks_beyond_max;
  scans_beyond_max += other.scans_beyond_max;
  landmarks_most = std::max(landmarks_most, other.landmarks_most);
  landmarks_at_one_place += other.landmarks_at_one_place;
  zero_ranges += other.zero_ranges;
}

std::string LeftOut::text() const {
  std::string lines;
  if (landmarks_beyond_max > 0) {
    const std::size_t enough = std::min<std::size_t>(landmarks_most, core::kScanLandmarksMax);
    lines += "left out         " + std::to_string(landmarks_beyond_max) + " landmarks in " +
             std::to_string(scans_beyond_max) + " scans that list up to " + std::to_string(landmarks_most) +
             "; --set detection.landmarks_max=" + std::to_string(enough) +
             (enough < landmarks_most ? " keeps the most that a scan can have\n" : " keeps them\n");
  }
  if (landmarks_at_one_place > 0) {
    lines += "counted once     " + std::to_string(landmarks_at_one_place) +
             " landmarks within 1 mm of another one of their scan were left out\n";
  }
  if (zero_ranges > 0) {
    lines += "no return        " + std::to_string(zero_ranges) +
             " readings with a range_m of 0 or less were taken for it\n";
  }
  return lines;
}

}  // namespace slamsensor::tools
