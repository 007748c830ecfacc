#pragma once

#include "tools/top/canvas.hpp"

#include <tl/expected.hpp>

#include <memory>
#include <optional>
#include <string>

struct screen;

namespace slamsensor::tools {

/// What a person pressed.
enum class TopKey : std::uint8_t { None, Quit, Sensor, Counters, Channels, NextPage, Up, Down, Redraw };

/// The terminal as a screen: taken over at creation, as it was before at the end. At most one at a time.
class Terminal {
 public:
  /// Colours are used unless NO_COLOR is set to something or the terminal has none. The error says what
  /// terminal it cannot use.
  [[nodiscard]] static tl::expected<std::unique_ptr<Terminal>, std::string> open();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal();

  /// Size in cells, as it is now.
  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;

  void show(const Canvas& canvas);

  /// The next key that was pressed; None when there is none. Never waits.
  [[nodiscard]] TopKey next_key();

 private:
  explicit Terminal(::screen* handle);

  ::screen* handle_;
  bool has_colours_ = false;
};

}  // namespace slamsensor::tools
