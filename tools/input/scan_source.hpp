#pragma once

#include "firmware/config/config.hpp"
#include "tools/input/input_error.hpp"
#include "tools/input/input_scan.hpp"
#include "tools/input/scan_files.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace slamsensor::tools {

/// The scans of one or more inputs, in the order of their times, one at a time: a cloud or a file of readings
/// is in memory only while it is handed out. One thread.
class ScanSource {
 public:
  ScanSource() = default;
  ScanSource(const ScanSource&) = delete;
  ScanSource& operator=(const ScanSource&) = delete;
  virtual ~ScanSource() = default;

  /// How many scans there are in all, known before the first is loaded.
  [[nodiscard]] virtual std::size_t count() const = 0;

  /// The next scan, or nothing after the last. An error concerns this scan alone: the call after it goes on
  /// with the one that follows.
  [[nodiscard]] virtual tl::expected<std::optional<InputScan>, InputError> next() = 0;

  /// The entries of the given folders that are not read, and why.
  [[nodiscard]] virtual std::span<const NotRead> not_read() const = 0;

  /// How the names of the files gave the order of the scans, in one line; empty where no order was needed.
  [[nodiscard]] virtual const std::string& order() const = 0;
};

/// Opens what `slamsensor replay` takes (DESIGN 6): files, or folders of files, of point clouds (.pcd),
/// readings (.csv) and landmark lists (.csv; the kind is told from the header). A scan's number and time come
/// from its file's name (label_scans), or from the list's scan column. An error when a path does not exist, a
/// folder holds no scan, a number is missing or taken twice, a landmark list is malformed, or a step in
/// `config` is not positive.
[[nodiscard]] tl::expected<std::unique_ptr<ScanSource>, InputError> open_scans(
    std::span<const std::filesystem::path> inputs, const firmware::Config& config);

}  // namespace slamsensor::tools
