#pragma once

#include "firmware/config/config.hpp"
#include "firmware/pipeline.hpp"
#include "hal/stamp.hpp"
#include "tools/replay/replay.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>

namespace slamsensor::tools {

/// The making of a Replay: a pipeline, and a row for each scan that goes through it.
class ReplayRun {
 public:
  ReplayRun(const firmware::Config& config, ReplayClock clock)
      : capacities_(config.core.capacities),
        deadline_(hal::from_seconds(config.daemon.realtime.slam_deadline_s)),
        clock_(clock),
        pipeline_(config.core) {}

  [[nodiscard]] firmware::Pipeline& pipeline() { return pipeline_; }
  /// What was gathered so far.
  [[nodiscard]] Replay& result() { return result_; }

  /// Takes the fix that `localise` makes of scan `number` within the deadline that it is given, and its
  /// time; `t_s` goes to the trajectory.
  const FixRow& add(std::int64_t number, double t_s,
                    const std::function<core::Fix(const core::Deadline&)>& localise);

  /// The run with its map, whose scans are named as the rows are; a scan of before the run is -1.
  [[nodiscard]] Replay finish();

 private:
  struct Named {
    std::int64_t number = 0;
    double t_s = 0.0;
  };

  [[nodiscard]] core::Deadline deadline_from(std::chrono::steady_clock::time_point begin) const;
  [[nodiscard]] std::int64_t number_of(std::uint32_t scan) const;
  void take_map(const core::Slam& slam);

  core::Capacities capacities_;
  std::chrono::nanoseconds deadline_;
  ReplayClock clock_;
  firmware::Pipeline pipeline_;
  Replay result_;
  std::map<std::uint32_t, Named> scans_;  // by core::Fix::scan
};

}  // namespace slamsensor::tools
