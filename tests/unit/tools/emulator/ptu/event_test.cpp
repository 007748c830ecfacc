#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace slamsensor::tools {
namespace {

// A line without length: keeps when each byte was sent.
class Recorder final : public ByteSink {
 public:
  void send(std::span<const std::uint8_t> bytes, Stamp at) override {
    for (const std::uint8_t byte : bytes) {
      sent.emplace_back(at, byte);
    }
  }
  [[nodiscard]] Stamp busy_until() const override { return {}; }
  void clear() override {}

  std::vector<std::pair<Stamp, std::uint8_t>> sent;
};

struct Typed {
  Stamp at;
  std::string text;
};

// All the unit does by itself for 20 s: reset, moves, velocities, tables, a wait, a stop that is hit.
const std::vector<Typed>& script() {
  static const std::vector<Typed> kScript = {{4s, "PP1234 A PP "},    {6s, "PA3000 PS2500 PP-3000 TP500 "},
                                             {7s, "PS700 PO-10 "},    {9s, "S PP0 TP0 A "},
                                             {13s, "CV PS300 "},      {15s, "CI "},
                                             {16s, "LD PP4000 A PP "}};
  return kScript;
}

template <typename Next>
std::vector<std::pair<Stamp, std::uint8_t>> play(Next next) {
  PtuSettings settings = ptu_settings(PtuKind::D46_17_5);
  settings.reset_time = 3s;
  settings.table_times.acceleration = 200ms;
  Recorder sink;
  EmulatedPtu ptu(settings, sink, 9);
  Stamp now{};
  for (const Typed& typed : script()) {
    while (now < typed.at) {
      now = std::min(next(ptu, now), typed.at);
      ptu.advance(now);
    }
    for (const char c : typed.text) {
      ptu.receive(static_cast<std::uint8_t>(c), now);
    }
  }
  while (now < 25s) {
    now = std::min(next(ptu, now), Stamp(25s));
    ptu.advance(now);
  }
  return sink.sent;
}

TEST(PtuEvents, AClockThatJumpsFromEventToEventSeesWhatAFineOneSees) {
  const auto jumping = play([](const EmulatedPtu& ptu, Stamp now) {
    EXPECT_GT(ptu.next_event(), now);  // what was due is done
    return ptu.next_event();
  });
  const auto fine = play([](const EmulatedPtu&, Stamp now) { return now + 137us; });
  ASSERT_GT(jumping.size(), 200U);
  ASSERT_EQ(jumping.size(), fine.size());
  for (std::size_t i = 0; i < fine.size(); ++i) {
    EXPECT_EQ(jumping[i], fine[i]) << i;
  }
}

TEST(PtuEvents, NothingIsDueForAUnitThatRests) {
  PtuBench bench;
  bench.ask("ED ");
  EXPECT_EQ(bench.ptu.next_event(), hal::kNever);
  bench.fault(FaultKind::PowerCycle, 1s);
  EXPECT_EQ(bench.ptu.next_event(), bench.now + 1s);
}

TEST(PtuEvents, WhereTheHeadWasASecondAgoIsStillKnown) {
  PtuBench bench;
  bench.ask("PP3000 ", 1500ms);
  const double then = bench.pan_steps(bench.now - 1s);
  bench.ask("PP-3000 ", 500ms);
  EXPECT_NEAR(bench.pan_steps(bench.now - 1500ms), then, 1e-6);
  EXPECT_GT(bench.pan_steps(bench.now - 500ms), bench.pan_steps(bench.now));
}

}  // namespace
}  // namespace slamsensor::tools
