#include "tools/top/top_frame.hpp"

#include "tools/top/channel_page.hpp"
#include "tools/top/map_sketch.hpp"
#include "tools/top/sensor_page.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace slamsensor::tools {
namespace {

constexpr int kTextWidth = 64;    // of the sensor's lines, beside a map
constexpr int kMapWidthMin = 24;  // narrower maps go below the text
constexpr int kPageTop = 2;

void draw_heading(const TopState& state, Canvas& canvas) {
  constexpr std::array<std::string_view, 3> kPages = {" 1 sensor ", " 2 counters ", " 3 channels "};
  canvas.put(0, 0, std::string(static_cast<std::size_t>(canvas.width()), ' '), CellStyle::Inverse);
  canvas.put(1, 0, "slamsensor top", CellStyle::Inverse);
  int x = 18;
  for (std::size_t i = 0; i < kPages.size(); ++i) {
    const bool is_chosen = static_cast<std::size_t>(state.choice.page) == i;
    canvas.put(x, 0, kPages.at(i), is_chosen ? CellStyle::Bold : CellStyle::Inverse);
    x += static_cast<int>(kPages.at(i).size());
  }
  canvas.put(x + 2, 0, "q quit", CellStyle::Inverse);
}

TextLine situation(const TopState& state, hal::Stamp now) {
  if (!state.problem.empty()) {
    return {state.problem, CellStyle::Bad};
  }
  if (!state.sensor.heard()) {
    return {"nothing heard from a sensor on " + state.sensor.prefix() + "* for " +
                duration_text(now - state.started) + "; is it running, and LCM enabled?",
            CellStyle::Warning};
  }
  const hal::Stamp silence = now - *state.sensor.heard();
  if (silence >= kSilentAfter) {
    return {"sensor silent for " + duration_text(silence) + "; what follows is old", CellStyle::Bad};
  }
  std::string text = "listening to " + state.sensor.prefix() + "*";
  if (state.refused + state.dropped > 0) {
    text += ", " + std::to_string(state.refused) + " foreign datagrams, " + std::to_string(state.dropped) +
            " messages in pieces lost";
  }
  return {text, CellStyle::Dim};
}

void draw_sensor(const TopState& state, hal::Stamp now, Canvas& canvas) {
  const TextLines lines = sensor_lines(state.sensor, now);
  const int left = canvas.height() - kPageTop;
  if (canvas.width() >= kTextWidth + 1 + kMapWidthMin) {
    put_lines(canvas, {0, kPageTop, kTextWidth, left}, lines);
    draw_map_sketch(state.sensor, {kTextWidth + 1, kPageTop, canvas.width() - kTextWidth - 1, left}, canvas);
    return;
  }
  const int below = put_lines(canvas, {0, kPageTop, canvas.width(), left}, lines);
  draw_map_sketch(state.sensor, {0, below, canvas.width(), canvas.height() - below}, canvas);
}

void draw_counters(const TopState& state, hal::Stamp now, Canvas& canvas) {
  TextLines lines = counter_lines(state.sensor, now);
  const int hidden = std::clamp(state.choice.first_line, 0, std::max(0, static_cast<int>(lines.size()) - 1));
  lines.erase(lines.begin(), lines.begin() + hidden);
  put_lines(canvas, {0, kPageTop, canvas.width(), canvas.height() - kPageTop}, lines);
}

void draw_channels(const TopState& state, hal::Stamp now, Canvas& canvas) {
  const std::size_t selected =
      std::min(state.choice.channel, std::max<std::size_t>(state.channels.channels().size(), 1) - 1);
  TextLines lines = channel_lines(state.channels, selected, now);
  // The heading stays; the list is scrolled so that the selected channel is within its half of the screen.
  const int rows = std::max(2, (canvas.height() - kPageTop) / 2);
  const int hidden = std::max(0, static_cast<int>(selected) + 2 - rows);
  lines.erase(lines.begin() + 1, lines.begin() + 1 + hidden);
  const int below = put_lines(canvas, {0, kPageTop, canvas.width(), rows}, lines);
  put_lines(canvas, {0, below + 1, canvas.width(), canvas.height() - below - 1},
            message_lines(state.channels, selected));
}

}  // namespace

void TopState::on_message(const LcmMessageView& message, hal::Stamp now) {
  channels.add(message, now);
  sensor.on_message(message, now);
}

Canvas draw_frame(const TopState& state, int width, int height, hal::Stamp now) {
  Canvas canvas(width, height);
  draw_heading(state, canvas);
  put_lines(canvas, {0, 1, canvas.width(), 1}, {situation(state, now)});
  switch (state.choice.page) {
    case TopPage::Sensor:
      draw_sensor(state, now, canvas);
      break;
    case TopPage::Counters:
      draw_counters(state, now, canvas);
      break;
    case TopPage::Channels:
      draw_channels(state, now, canvas);
      break;
  }
  return canvas;
}

}  // namespace slamsensor::tools
