#pragma once

#include "tools/emulator/emulated_port.hpp"
#include "tools/emulator/ptu/emulated_ptu.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

using namespace std::chrono_literals;

/// A unit that is ready, with exactly the figures of its model, and answers without jitter.
[[nodiscard]] PtuSettings exact_settings(PtuKind kind = PtuKind::D46_17_5);

/// An emulated unit on a serial line, and a host that types.
class PtuBench {
 public:
  explicit PtuBench(const PtuSettings& settings = exact_settings(), std::uint64_t seed = 1)
      : port(seed), ptu(settings, port, seed) {
    port.attach(ptu);
  }

  EmulatedPort port;
  EmulatedPtu ptu;
  Stamp now{};
  std::vector<WireByte> bytes;  ///< all that has arrived at the host since the last heard()

  void type(std::string_view text);
  void run_to(Stamp until);
  void run_for(Stamp span) { run_to(now + span); }

  /// All that has arrived since the last call.
  [[nodiscard]] std::string heard();

  /// What comes within `span` after `text` was typed, and nothing before.
  std::string ask(std::string_view text, Stamp span = 200ms);

  void fault(FaultKind kind, Stamp duration = {});

  /// The pan angle in positions of a PTU-46-17.5.
  [[nodiscard]] double pan_steps(Stamp at) const;
  [[nodiscard]] double tilt_steps(Stamp at) const;
};

/// `bytes` with control characters and bytes above ASCII made visible.
[[nodiscard]] std::string ptu_text(std::string_view bytes);

}  // namespace slamsensor::tools
