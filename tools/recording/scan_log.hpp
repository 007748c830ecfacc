#pragma once

#include "core/fix.hpp"
#include "core/landmark.hpp"
#include "firmware/lcm/scan_message.hpp"
#include "tools/recording/event_log_reader.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// A scan that the sensor sent as landmarks.
struct LoggedScan {
  std::int64_t number = 0;
  core::ScanTime time;
  std::vector<core::ScanLandmark> landmarks;  ///< heaviest first
};

/// The scans in the slamsensor.scan_t messages of an LCM event log, on whichever channel they are, in their
/// order. A scan of which a message is missing is refused, not given out.
class ScanLog {
 public:
  /// Those of the recording `part` of the file (RecordingFile::part).
  ScanLog(const std::filesystem::path& path, std::size_t part);

  /// The next scan, or nothing after the last.
  [[nodiscard]] std::optional<LoggedScan> next();

  /// What was wrong with scans that were refused so far, each in a sentence.
  [[nodiscard]] const std::vector<std::string>& refused() const noexcept { return refused_; }
  /// Messages read so far.
  [[nodiscard]] std::size_t messages() const noexcept { return messages_; }

 private:
  [[nodiscard]] std::optional<firmware::ScanMessage> next_message();
  void add(const firmware::ScanMessage& message);
  void refuse_scan();

  std::string name_;
  std::ifstream file_;
  LogPartReader log_;
  std::size_t part_;
  LoggedScan scan_;
  std::int32_t chunks_ = 0;                   // that scan_ has so far; 0: none is begun
  std::int64_t begun_by_ = 0;                 // initialization of the daemon that sent it
  std::optional<std::int64_t> refused_scan_;  // the last
  std::vector<std::string> refused_;
  std::size_t messages_ = 0;
};

}  // namespace slamsensor::tools
