#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/ptu/ptu_unit.hpp"
#include "tools/world/random.hpp"

#include <cstddef>
#include <string>
#include <string_view>

namespace slamsensor::tools {

/// Who gets what the unit says: the host, or its own store until it is selected.
enum class PtuAudience : std::uint8_t { Host, Store };

/// The unit's mouth: what it says and what faults make of it.
class PtuPort {
 public:
  PtuPort(ByteSink& sink, std::size_t capacity, std::uint64_t seed)
      : sink_(sink), capacity_(capacity), rng_(seed) {}

  /// From now on speaks to `audience`; the host gets what was stored.
  void turn_to(PtuAudience audience, Stamp now);

  /// Echo and banner; nothing that waits for a host who does not listen.
  void say(std::string_view bytes, Stamp now);

  /// The answer to a command: the one that the faults of replies befall.
  void answer(const std::string& bytes, PtuForm form, Stamp now);

  /// An axis has run into a limit.
  void report(PtuAxisId axis, PtuForm form, Stamp now);

  /// Sends nothing until `until`.
  void be_silent(Stamp until);

  /// The next answer is lost, comes twice, or has a limit report in it; false for other faults.
  bool befall(FaultKind kind);

  /// Without power: nothing is sent any more.
  void cut_power();

 private:
  void send(std::string_view bytes, Stamp now);

  ByteSink& sink_;
  std::size_t capacity_;
  Random rng_;
  PtuAudience audience_ = PtuAudience::Host;
  std::string stored_;
  Stamp silent_until_ = Stamp::min();
  unsigned swallow_ = 0;
  unsigned twice_ = 0;
  unsigned limit_inside_ = 0;
};

}  // namespace slamsensor::tools
