#pragma once

#include "tools/emulator/rangefinder/point_settings.hpp"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// What the device does besides answering a command.
enum class PointAction : std::uint8_t { None, Measure, Track, Stop, Restart };

struct PointAnswer {
  std::string text;  ///< with its line ends
  PointAction action = PointAction::None;
};

/// Parameters of an LDS70A or LDM41E and the commands that show and set them. They are kept at once.
class PointCommands {
 public:
  explicit PointCommands(const PointSettings& settings);

  /// Does `line`, which came without its CR. Unknown commands and wrong values are answered "?".
  [[nodiscard]] PointAnswer run(std::string_view line);

  /// The answer of HW, after a shot that looked like `sight`.
  void note(const Sight& sight) { last_kind_ = sight.kind; }

  [[nodiscard]] const PointFormat& format() const { return format_; }
  [[nodiscard]] std::uint32_t baud() const { return baud_; }
  void set_baud(std::uint32_t baud);
  [[nodiscard]] std::string_view autostart() const { return values_.at("AS"); }

  /// Readings per second: MF / SA, at most what the manual's table 7 and the line allow.
  [[nodiscard]] double rate_hz() const;

  /// `range_m` with the offset on it, m.
  [[nodiscard]] double with_offset_m(double range_m) const { return range_m + offset_m_; }

  /// Whether a distance is inside the measurement window, m.
  [[nodiscard]] bool is_in_window(double range_m) const {
    return range_m >= window_min_m_ && range_m <= window_max_m_;
  }

  /// Whether a failed measurement repeats the last distance (SE 0) or is told (SE 1).
  [[nodiscard]] bool repeats_on_error() const { return values_.at("SE") == "0"; }

 private:
  using Values = std::map<std::string, std::string, std::less<>>;
  using Numbers = std::vector<double>;

  void load_factory();
  [[nodiscard]] std::optional<PointAction> action_of(std::string_view command) const;
  [[nodiscard]] std::optional<std::string> text_of(std::string_view command) const;
  [[nodiscard]] std::string parameter_list() const;
  [[nodiscard]] std::string hardware_text() const;
  [[nodiscard]] bool set(const std::string& command, std::string_view values);
  [[nodiscard]] bool set_numbers(const std::string& command, const Numbers& numbers);
  [[nodiscard]] bool set_format(const Numbers& numbers);
  [[nodiscard]] bool set_letter_format(std::string_view letter);
  [[nodiscard]] bool set_terminator(double code);
  void set_binary_unit(double units_per_m);

  const PointSettings& settings_;
  PointFormat format_;
  std::uint32_t baud_;
  double frequency_hz_ = 0.0;
  double average_ = 1.0;
  double offset_m_ = 0.0;
  double window_min_m_ = 0.0;
  double window_max_m_ = 0.0;
  SightKind last_kind_ = SightKind::Target;
  Values values_;  // as they are shown
};

}  // namespace slamsensor::tools
