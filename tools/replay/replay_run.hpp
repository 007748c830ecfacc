#pragma once

#include "firmware/config/config.hpp"
#include "firmware/pipeline.hpp"
#include "tools/replay/replay.hpp"

#include <cstdint>
#include <functional>
#include <map>

namespace slamsensor::tools {

/// The making of a Replay: a pipeline, and a row for each scan that goes through it.
class ReplayRun {
 public:
  explicit ReplayRun(const firmware::Config& config) : pipeline_(config.core) {}

  [[nodiscard]] firmware::Pipeline& pipeline() { return pipeline_; }
  /// What was gathered so far.
  [[nodiscard]] Replay& result() { return result_; }

  /// Takes the fix that `localise` makes of scan `number`, and its time; `t_s` goes to the trajectory.
  const FixRow& add(std::int64_t number, double t_s, const std::function<core::Fix()>& localise);

  /// The run with its map, whose scans are named as the rows are; a scan of before the run is -1.
  [[nodiscard]] Replay finish();

 private:
  [[nodiscard]] std::int64_t number_of(std::uint32_t scan) const;
  void take_map(const core::HypothesisSet& hypotheses);

  firmware::Pipeline pipeline_;
  Replay result_;
  std::map<std::uint32_t, std::int64_t> numbers_;  // of scans, by core::Fix::scan
};

}  // namespace slamsensor::tools
