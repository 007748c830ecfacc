#pragma once

#include "firmware/device/head_drivers.hpp"
#include "firmware/scan/sensor_head.hpp"
#include "tests/rt/rehearsal.hpp"
#include "tests/rt/taped_links.hpp"
#include "tools/emulator/scenario.hpp"

#include <cstddef>
#include <functional>
#include <memory>

namespace slamsensor::tests {

/// What the links of both devices of an emulated head gave to their drivers while somebody led them.
struct HeadTape {
  LinkTape pan_tilt{};
  LinkTape rangefinder{};
  std::size_t steps = 0;  ///< of a millisecond each, from 0 on
};

/// The drivers of a tape, and the one who leads them.
class HeadRun {
 public:
  HeadRun(const firmware::HeadLinks& links, const tools::HeadProfile& profile);
  virtual ~HeadRun() = default;
  HeadRun(const HeadRun&) = delete;
  HeadRun& operator=(const HeadRun&) = delete;

  /// The next millisecond.
  virtual void step(hal::Stamp now) noexcept = 0;

  [[nodiscard]] const firmware::HeadDrivers& drivers() const noexcept { return drivers_; }

 private:
  firmware::HeadDrivers drivers_;
};

/// Both devices on their own: the pan swept to and fro whenever it stands, everything taken.
class DriversRun final : public HeadRun {
 public:
  using HeadRun::HeadRun;
  void step(hal::Stamp now) noexcept override;

  std::size_t readings = 0;
  std::size_t positions = 0;

 private:
  double side_ = 1.0;
};

/// A sensor head that makes scans of them.
class ScanRun final : public HeadRun {
 public:
  ScanRun(const firmware::HeadLinks& links, const tools::HeadProfile& profile,
          const firmware::SensorHeadConfig& config);
  void step(hal::Stamp now) noexcept override;

  std::size_t scans = 0;
  std::size_t lines = 0;
  std::size_t readings = 0;

 private:
  std::unique_ptr<firmware::SensorHead> sensor_;
};

using MakeRun = std::function<std::unique_ptr<HeadRun>(const firmware::HeadLinks& links)>;

/// A run of `steps` milliseconds on the emulated devices of `scenario`, on tape.
[[nodiscard]] HeadTape record(const tools::Scenario& scenario, std::size_t steps, const MakeRun& make);

/// Steps `run`, whose drivers are on replayed links, through the whole tape.
void replay(const HeadTape& tape, HeadRun& run) noexcept;

/// Checks that what `replay_once` does costs no heap call, no page fault and less stack than `stack_max`;
/// says what it cost. Skips what cannot be measured here.
void expect_real_time(const char* name, std::size_t stack_max_bytes,
                      const std::function<Cost()>& replay_once);

/// Links that replay a tape, of the kinds that `profile` has.
class ReplayedLinks {
 public:
  ReplayedLinks(const HeadTape& tape, const tools::HeadProfile& profile);

  [[nodiscard]] firmware::HeadLinks get() noexcept { return links_; }
  /// Calls that were not made when the tape was recorded: 0 for an honest replay.
  [[nodiscard]] std::size_t beyond() const noexcept;

 private:
  ReplayedByteLink pan_tilt_bytes_;
  ReplayedByteLink rangefinder_bytes_;
  ReplayedCanLink pan_tilt_can_;
  ReplayedCanLink rangefinder_can_;
  firmware::HeadLinks links_;
};

}  // namespace slamsensor::tests
