#pragma once

#include "tools/emulator/ptu/ptu_head.hpp"

#include <string>
#include <vector>

namespace slamsensor::tools {

/// What the host types and what its source shows to come back, line ends included.
struct PtuExchange {
  std::string host;
  std::string unit;
  Stamp span = std::chrono::milliseconds(300);  ///< in which the answer comes
};

/// A session as a manual prints it or somebody captured it.
struct PtuSession {
  std::string title;
  std::string source;
  PtuSettings settings;
  std::vector<PtuExchange> prelude;  ///< brings the unit into the state that the source begins with
  std::vector<PtuExchange> exchanges;
};

[[nodiscard]] std::vector<PtuSession> ptu_sessions();

}  // namespace slamsensor::tools
