#pragma once

#include "hal/stamp.hpp"

#include <tl/expected.hpp>

#include <chrono>
#include <memory>
#include <ostream>
#include <string>

namespace slamsensor::tests {

/// What every rig of a contract test has: a time that only it moves. Transports are told this time; it goes
/// on at the tests' word, whether the far end is simulated or takes real time.
class Rig {
 public:
  Rig() = default;
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  virtual ~Rig() = default;

  /// The time to tell the link.
  [[nodiscard]] virtual hal::Stamp now() const = 0;

  /// Lets `time` pass; a rig of real things also gives them a moment to get on.
  virtual void pass(hal::Stamp time) = 0;

  /// Now, on the clock that the link stamps with.
  [[nodiscard]] virtual hal::Stamp stamping_clock() const = 0;
};

/// A rig, or why there can be none here: the test is then skipped with these words.
template <typename R>
using MadeRig = tl::expected<std::unique_ptr<R>, std::string>;

/// The parameter of a contract suite.
template <typename R>
struct RigMaker {
  const char* name;  ///< letters and digits, for the name of the test
  MadeRig<R> (*make)();

  friend std::ostream& operator<<(std::ostream& out, const RigMaker& maker) { return out << maker.name; }
};

/// For the last argument of INSTANTIATE_TEST_SUITE_P.
struct RigName {
  template <typename Info>
  std::string operator()(const Info& info) const {
    return info.param.name;
  }
};

}  // namespace slamsensor::tests
