#include "tools/input/scan_source.hpp"

#include "tools/input/cloud_scanlines.hpp"
#include "tools/input/file.hpp"
#include "tools/input/landmark_csv.hpp"
#include "tools/input/pcd.hpp"
#include "tools/input/readings_csv.hpp"
#include "tools/input/scan_files.hpp"
#include "tools/input/scan_names.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tools {
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

Status add_list(const ScanFile& file, const firmware::Config& config, std::vector<Entry>& entries) {
  const std::string name = file.path.string();
  const auto text = read_file(file.path);
  if (!text) {
    return tl::unexpected(text.error());
  }
  const auto list = parse_landmark_csv(*text, name);
  if (!list) {
    return tl::unexpected(list.error());
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
  FileScanSource(std::vector<Entry> entries, std::vector<NotRead> not_read, std::string order,
                 const firmware::Config& config)
      : entries_(std::move(entries)),
        not_read_(std::move(not_read)),
        order_(std::move(order)),
        config_(config) {}

  std::size_t count() const override { return entries_.size(); }

  tl::expected<std::optional<InputScan>, InputError> next() override {
    if (at_ == entries_.size()) {
      return std::optional<InputScan>();
    }
    const Entry& entry = entries_[at_++];
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
      scan.landmarks = select_landmarks(entry.rows, config_.landmark_list, config_.core.detection);
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
    return parse_readings_csv(text, scan.name, config_.scan_head.levelling).map([&](auto&& scanlines) {
      scan.scanlines = std::forward<decltype(scanlines)>(scanlines);
    });
  }

  std::vector<Entry> entries_;
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
  std::vector<ScanFile> own_files;
  for (const ScanFile& file : files->scans) {
    if (file.kind != ScanFileKind::Landmarks) {
      own_files.push_back(file);
    } else if (auto added = add_list(file, config, entries); !added) {
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
  return std::make_unique<FileScanSource>(std::move(entries), std::move(files->not_read), std::move(*order),
                                          config);
}

}  // namespace slamsensor::tools
