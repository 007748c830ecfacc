#pragma once

#include "tools/spy/channel_table.hpp"
#include "tools/top/canvas.hpp"
#include "tools/top/sensor_view.hpp"

#include <string>

namespace slamsensor::tools {

enum class TopPage : std::uint8_t { Sensor, Counters, Channels };

/// What the person has chosen.
struct TopChoice {
  TopPage page = TopPage::Sensor;
  std::size_t channel = 0;  ///< selected on the page of channels
  int first_line = 0;       ///< scrolled to on the page of counters
};

/// What a frame is drawn from.
struct TopState {
  explicit TopState(const std::string& prefix) : sensor(prefix) {}

  SensorView sensor;
  ChannelTable channels;
  TopChoice choice;
  std::string problem;  ///< of listening; empty: none
  hal::Stamp started{};
  std::uint64_t refused = 0;  ///< datagrams that were not LCM's
  std::uint64_t dropped = 0;  ///< messages of which fragments were lost

  /// Takes in a message.
  void on_message(const LcmMessageView& message, hal::Stamp now);
};

/// How long a sensor may say nothing before it counts as silent.
inline constexpr hal::Stamp kSilentAfter = std::chrono::seconds(12);

/// The chosen page, at whatever size: a heading with the keys, a line that says what is wrong with listening
/// or that the sensor is silent, then the page.
[[nodiscard]] Canvas draw_frame(const TopState& state, int width, int height, hal::Stamp now);

}  // namespace slamsensor::tools
