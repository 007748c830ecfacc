// The scan thread's whole body, SensorHead with its drivers, scheduler, assembler and calibration, through
// whole scans: no memory, no page fault, little stack.
#include "tests/rt/taped_head.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace slamsensor::tests {
namespace {

constexpr std::size_t kStackMax_bytes = 128 * 1024;

struct Head {
  const char* name;
  tools::HeadKind kind;
  std::size_t steps;
  std::size_t scans_min;
};

void PrintTo(const Head& head, std::ostream* out) {
  *out << head.name;
}

tools::Scenario scenario_of(const Head& head) {
  tools::Scenario scenario;
  scenario.seed = 11;
  scenario.head = tools::head_profile(head.kind);
  scenario.head.ptu.reset_s = 3.0;
  scenario.drive.stands = 1;
  return scenario;
}

firmware::SensorHeadConfig config_of(const Head& head) {
  firmware::SensorHeadConfig config;
  config.latency.initial_sigma_s = 0.0005;  // known: lines with an unknown latency are not handed out
  if (head.kind == tools::HeadKind::Fast) {
    config.scan.pan_speed_radps = 5.0;
    config.scan.tilt_speed_radps = 5.0;
    config.scan.tilt_step_rad = 0.028;
    config.levelling.source = firmware::InclinationSource::Fixed;
    config.levelling.fixed = {0.03, -0.02};
  } else {
    config.scan.tilt_step_rad *= 5.0;  // eleven lines: enough of the same
  }
  return config;
}

class HeadInRealTime : public testing::TestWithParam<Head> {
 protected:
  Cost cost_of_replay() {
    ReplayedLinks links(tape_, scenario_.head);
    ScanRun run(links.get(), scenario_.head, config_of(GetParam()));
    if (!hold_memory()) {
      ADD_FAILURE() << "memory was held before and cannot be held now";
    }
    const Cost cost = cost_of([&] { replay(tape_, run); });
    EXPECT_EQ(links.beyond(), 0U) << "the head did something else than when it was recorded";
    EXPECT_GE(run.scans, GetParam().scans_min);
    EXPECT_GT(run.readings, 10'000U);
    return cost;
  }

  tools::Scenario scenario_ = scenario_of(GetParam());
  HeadTape tape_ = record(scenario_, GetParam().steps, [this](const firmware::HeadLinks& links) {
    return std::make_unique<ScanRun>(links, scenario_.head, config_of(GetParam()));
  });
};

TEST_P(HeadInRealTime, TakesNoMemoryNoPageFaultAndLittleStack) {
  expect_real_time(GetParam().name, kStackMax_bytes, [this] { return cost_of_replay(); });
}

INSTANTIATE_TEST_SUITE_P(Heads, HeadInRealTime,
                         testing::Values(Head{"Paper", tools::HeadKind::Paper, 240'000, 2},
                                         Head{"Fast", tools::HeadKind::Fast, 90'000, 2}),
                         [](const auto& head) { return std::string(head.param.name); });

}  // namespace
}  // namespace slamsensor::tests
