#pragma once

#include "core/fix.hpp"
#include "firmware/recording/map_order.hpp"
#include "tools/input/input_error.hpp"
#include "tools/recording/tape_player.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// All of one recording but its tape, or of any other LCM event log. The tape is read chunk by chunk.
struct RecordingFile {
  std::filesystem::path path;
  std::size_t part = 0;  ///< which of the recordings in the file, where several were joined
  std::uint64_t events = 0;
  std::optional<std::string> config;  ///< TOML of the settings in force
  std::vector<std::uint8_t> map;      ///< the file of the map that the run began with; empty without one
  std::int64_t chunks = 0;            ///< of tape, undamaged
  std::int64_t scan_messages = 0;     ///< slamsensor.scan_t
  std::vector<firmware::MapOrder> orders;
  std::map<hal::Stamp, core::Fix>
      fixes;                        ///< as they were sent, by the end of their scan on the sensor's clock
  bool is_truncated = false;        ///< it ends within an event, as a log does whose logger was killed
  std::vector<std::string> damage;  ///< what is wrong with the file, each in a sentence
};

/// Whether `path` is a file that begins as an LCM event log does.
[[nodiscard]] bool is_event_log_file(const std::filesystem::path& path);

/// Reads all of `path` once. Each recording in it, at least one, in the order of the file. Damage is no
/// error: what is whole counts.
[[nodiscard]] tl::expected<std::vector<RecordingFile>, InputError> open_recordings(
    const std::filesystem::path& path);

/// The undamaged chunks of the tape of `recording`, in the order of the file.
[[nodiscard]] std::unique_ptr<ChunkSource> open_tape(const RecordingFile& recording);

}  // namespace slamsensor::tools
