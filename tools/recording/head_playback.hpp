#pragma once

#include "firmware/config/config.hpp"
#include "firmware/scan/sensor_head.hpp"
#include "tools/input/input_error.hpp"
#include "tools/recording/playback_links.hpp"
#include "tools/recording/tape_player.hpp"

#include <tl/expected.hpp>

#include <memory>
#include <optional>

namespace slamsensor::tools {

/// A recorded sensor head: its drivers and its scan scheduler at work again, on a tape instead of devices.
/// Gives the same readings, scanlines and scans as when it was recorded, bit for bit.
class HeadPlayback {
 public:
  /// The head that `config` describes on the tape from `chunks`, which outlives this. Refused when `config`
  /// asks for other devices than the tape has.
  [[nodiscard]] static tl::expected<std::unique_ptr<HeadPlayback>, InputError> create(
      ChunkSource& chunks, const firmware::Config& config);

  /// The next thing that the head did; nothing when the tape is over. What an interrupted last step did is
  /// left out. Spans are valid until the next call.
  [[nodiscard]] std::optional<firmware::HeadEvent> next();

  [[nodiscard]] const TapePlayer& player() const noexcept { return player_; }
  [[nodiscard]] const firmware::SensorHead& sensor() const noexcept { return *sensor_; }
  [[nodiscard]] const firmware::HeadDrivers& drivers() const noexcept { return drivers_; }

 private:
  explicit HeadPlayback(ChunkSource& chunks) : player_(chunks), links_(playback_links(player_)) {}
  [[nodiscard]] tl::expected<void, InputError> start(const firmware::Config& config);

  TapePlayer player_;
  firmware::OwnedHeadLinks links_;
  firmware::HeadDrivers drivers_;
  std::unique_ptr<firmware::SensorHead> sensor_;
};

}  // namespace slamsensor::tools
