#pragma once

#include "tools/emulator/rangefinder/tf03_settings.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tools {

/// What the device does besides answering a command.
enum class Tf03Action : std::uint8_t { None, Restart, Trigger, Retime };

struct Tf03Answer {
  std::vector<std::uint8_t> bytes;  ///< empty: none
  Tf03Action action = Tf03Action::None;
};

/// The settings of a TF03 and the commands that change them (TF03 manual V1.2.2, table 8, and V0.4, 4.3).
/// Changes are lost at the next start unless they were saved.
class Tf03Commands {
 public:
  explicit Tf03Commands(const Tf03Settings& settings);

  /// What the device works with at present.
  [[nodiscard]] const Tf03Parameters& active() const { return active_; }

  /// The device starts: what was saved counts.
  void start_up();

  /// Does `command` (whole, sum checked). Nothing when the device does not answer: unknown, wrong length or
  /// a value that cannot be.
  [[nodiscard]] std::optional<Tf03Answer> run(std::span<const std::uint8_t> command);

  /// The factory's line rate counts from now on, and after every start.
  void reset_baud();

  /// Nothing is sent any more before a command asks for it, or a restart.
  void stop_output() { wanted_.output = active_.output = Tf03Switch::Off; }

 private:
  using Payload = std::span<const std::uint8_t>;

  [[nodiscard]] std::optional<Tf03Answer> run_measuring(std::uint8_t id, Payload payload);
  [[nodiscard]] std::optional<Tf03Answer> run_line(std::uint8_t id, Payload payload);
  [[nodiscard]] std::optional<Tf03Answer> set_baud(Payload payload);
  [[nodiscard]] std::optional<Tf03Answer> set_wire(Payload payload);
  [[nodiscard]] bool set_can(std::uint8_t id, std::uint32_t value);
  void apply();

  const Tf03Settings& settings_;
  Tf03Parameters saved_;
  Tf03Parameters wanted_;  // as the commands left it; save keeps it
  Tf03Parameters active_;  // wanted_ but for what needs a restart
};

}  // namespace slamsensor::tools
