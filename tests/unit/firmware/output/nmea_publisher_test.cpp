#include "firmware/output/nmea_publisher.hpp"

#include "firmware/serving/epoch_sink.hpp"
#include "tests/support/no_alloc_scope.hpp"
#include "tests/unit/firmware/output/nmea_lines.hpp"

#include <gmock/gmock.h>

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tests {
namespace {

/// Keeps what it is given.
class EpochCollector final : public firmware::EpochSink {
 public:
  EpochCollector() { bytes_.reserve(1 << 20); }

  void step(hal::Stamp) noexcept override {}
  void send(std::span<const char> epoch, const firmware::OutputTime&) noexcept override {
    bytes_.append(epoch.data(), epoch.size());
    ++epochs_;
  }
  std::size_t poll_on(std::span<pollfd>) const noexcept override { return 0; }
  std::string_view problem() const noexcept override { return problem_; }
  std::span<const hal::Counter> counters() const noexcept override { return counters_; }

  void set_problem(std::string_view problem) { problem_ = problem; }
  [[nodiscard]] int epochs() const { return epochs_; }
  /// The fields of the sentences of `type` since the last call.
  std::vector<std::vector<std::string>> take(const std::string& type) {
    std::vector<std::vector<std::string>> result;
    for (std::size_t begin = 0; begin < bytes_.size();) {
      const std::size_t end = bytes_.find("\r\n", begin);
      const std::string line = bytes_.substr(begin, end - begin);
      if (line.find(type) == 1 || line.find(type) == 3) {
        result.push_back(fields(line));
      }
      begin = end + 2;
    }
    bytes_.clear();
    return result;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  int epochs_ = 0;
  std::string_view problem_;
  std::array<hal::Counter, 1> counters_{{{"collector_epochs", 7}}};
};

}  // namespace
}  // namespace slamsensor::tests

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using namespace tests;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::chrono::nanoseconds kNoon =
    std::chrono::sys_days(std::chrono::year(2026) / 3 / 1).time_since_epoch() + 12h;
constexpr hal::Stamp kUptime = 5000s;

OutputTime at(std::chrono::nanoseconds since) {
  return {kUptime + since, kNoon + since};
}

class Publisher : public testing::Test {
 protected:
  Publisher() {
    EXPECT_TRUE(publisher_.add(sink_));
    status_.state = SensorState::Starting;
    status_.report.fix.reason = core::FixReason::Device;
  }

  /// A scan that began 4 s before `end` and ended there has given `fix`.
  void scan(core::FixStatus status, std::chrono::nanoseconds end) {
    core::Fix& fix = status_.report.fix;
    fix = good_fix();
    fix.status = status;
    fix.reason = status == core::FixStatus::Fix ? core::FixReason::None : core::FixReason::NoOverlap;
    fix.time = {kNoon + end - 4s, kNoon + end - 2s, kNoon + end, kUptime + end};
    status_.state = status == core::FixStatus::Fix         ? SensorState::Fixed
                    : status == core::FixStatus::Ambiguous ? SensorState::Ambiguous
                                                           : SensorState::Lost;
  }

  /// Steps every `step` from the time of the last step until `end`.
  void run_to(std::chrono::nanoseconds end, std::chrono::nanoseconds step = 10ms) {
    for (; now_ < end; now_ += step) {
      status_.report.monotonic = kUptime + now_;
      publisher_.step(at(now_), status_);
    }
  }

  std::uint64_t counter(std::string_view name) {
    CounterTable table;
    publisher_.append_counters(table);
    for (const hal::Counter& counter : table.all()) {
      if (counter.name == name) {
        return counter.value;
      }
    }
    ADD_FAILURE() << "no counter " << name;
    return 0;
  }

  std::chrono::nanoseconds now_ = 500ms;
  SensorStatus status_;
  EpochCollector sink_;
  NmeaPublisher publisher_{{NmeaConfig{}, 1.0, kDatum}};
};

TEST_F(Publisher, BeforeTheFirstScanEveryEpochSaysNoFix) {
  run_to(3100ms);
  const auto pslma = sink_.take("PSLMA");
  ASSERT_EQ(pslma.size(), 3U);
  for (const auto& epoch : pslma) {
    EXPECT_EQ(epoch[3], "V");
    EXPECT_EQ(epoch[5], "6");
    EXPECT_EQ(epoch[14], "");
  }
  EXPECT_EQ(counter("nmea_epochs"), 3U);
  EXPECT_EQ(counter("nmea_epochs_prompt"), 0U);
}

TEST_F(Publisher, TheAnswerOfAScanIsWrittenInTheStepThatBringsIt) {
  run_to(1300ms);
  sink_.take("RMC");
  scan(core::FixStatus::Fix, 1300ms);
  run_to(1310ms);
  EXPECT_THAT(sink_.bytes(), StartsWith("$GPRMC,120001.30,A,4727.1234560,N"));
  const auto pslma = sink_.take("PSLMA");
  ASSERT_EQ(pslma.size(), 1U);
  EXPECT_EQ(pslma[0][14], "2.00");  // the middle of the scan is 2 s before its end
}

TEST_F(Publisher, BetweenScansTheFixIsRepeatedUnderTheTimeOfEachEpoch) {
  scan(core::FixStatus::Fix, 400ms);
  run_to(4100ms);
  const auto gga = sink_.take("GGA");
  ASSERT_EQ(gga.size(), 5U);  // one at once, four of the grid
  EXPECT_EQ(gga[0][1], "120000.50");
  for (std::size_t i = 1; i < gga.size(); ++i) {
    EXPECT_EQ(gga[i][1], "12000" + std::to_string(i) + ".00");
    EXPECT_EQ(gga[i][2], gga[0][2]);
    EXPECT_EQ(gga[i][6], "1");
  }
  run_to(6050ms);
  const auto pslma = sink_.take("PSLMA");
  ASSERT_EQ(pslma.size(), 2U);
  EXPECT_EQ(pslma[1][2], "120006.00");
  EXPECT_EQ(pslma[1][14], "7.60");
}

TEST_F(Publisher, AScanWithoutAFixWithdrawsTheOneBeforeAtOnce) {
  scan(core::FixStatus::Fix, 400ms);
  run_to(1700ms);
  scan(core::FixStatus::NoFix, 1690ms);
  sink_.take("RMC");
  run_to(1710ms);
  EXPECT_THAT(sink_.bytes(), StartsWith("$GPRMC,120001.70,V,"));
  EXPECT_EQ(counter("nmea_epochs_prompt"), 2U);
}

TEST_F(Publisher, ADeviceThatIsLostEndsTheFixAtOnceAndItsReturnAloneDoesNotBringItBack) {
  scan(core::FixStatus::Fix, 400ms);
  run_to(2600ms);
  sink_.take("RMC");
  status_.state = SensorState::Faulted;  // whatever the report still says
  run_to(2610ms);
  const auto pslma = sink_.take("PSLMA");
  ASSERT_EQ(pslma.size(), 1U);
  EXPECT_EQ(pslma[0][3], "V");
  EXPECT_EQ(pslma[0][5], "6");
  run_to(5050ms);
  for (const auto& epoch : sink_.take("GGA")) {
    EXPECT_EQ(epoch[6], "0");
  }
}

TEST_F(Publisher, AnAmbiguousPoseIsReportedOnTheMapAlone) {
  scan(core::FixStatus::Ambiguous, 400ms);
  run_to(1050ms);
  EXPECT_THAT(sink_.bytes(), HasSubstr(",V,,"));
  const auto pslma = sink_.take("PSLMA");
  ASSERT_EQ(pslma.size(), 2U);
  EXPECT_EQ(pslma[1][3], "U");
}

TEST_F(Publisher, AFixIsReportedInTheStateFixedAlone) {
  scan(core::FixStatus::Fix, 400ms);
  status_.report.monotonic = kUptime;
  for (const SensorState state : {SensorState::Starting, SensorState::Scanning, SensorState::Ambiguous,
                                  SensorState::Lost, SensorState::Held, SensorState::Faulted}) {
    status_.state = state;
    EXPECT_EQ(shown_fix(status_, kUptime).status, core::FixStatus::NoFix)
        << kSensorStateNames[std::size_t(state)];
  }
  status_.state = SensorState::Fixed;
  EXPECT_EQ(shown_fix(status_, kUptime + 5s).status, core::FixStatus::Fix);
}

TEST_F(Publisher, AReportThatNobodyRenewsIsNoFixAnyMore) {
  scan(core::FixStatus::Fix, 400ms);
  status_.report.monotonic = kUptime + 500ms;
  for (; now_ < 8s; now_ += 10ms) {
    publisher_.step(at(now_), status_);
  }
  const auto pslma = sink_.take("PSLMA");
  EXPECT_EQ(pslma[5][3], "A");
  EXPECT_EQ(pslma.back()[3], "V");
  EXPECT_EQ(pslma.back()[5], "5");
}

TEST_F(Publisher, WithoutPromptEpochsTheAnswerWaitsForTheGrid) {
  NmeaConfig config;
  config.prompt = false;
  publisher_.set_config({config, 1.0, kDatum});
  run_to(1300ms);
  scan(core::FixStatus::Fix, 1290ms);
  run_to(2050ms);
  const auto rmc = sink_.take("RMC");
  ASSERT_EQ(rmc.size(), 2U);
  EXPECT_EQ(rmc[1][1], "120002.00");
  EXPECT_EQ(rmc[1][2], "A");
}

TEST_F(Publisher, ZdaComesOnceASecondAtAnyRate) {
  NmeaConfig config;
  config.zda = true;
  publisher_.set_config({config, 10.0, kDatum});
  run_to(5050ms);
  const auto zda = sink_.take("ZDA");
  ASSERT_EQ(zda.size(), 6U);  // the first one in the rest of its second
  EXPECT_EQ(zda.back()[1], "120005.00");
  EXPECT_EQ(zda.back()[4], "2026");
}

TEST_F(Publisher, AnEmulatedHeadCallsItselfSimulated) {
  scan(core::FixStatus::Fix, 400ms);
  status_.report.source = SourceMode::Emulated;
  run_to(1050ms);
  const auto gga = sink_.take("GGA");
  EXPECT_EQ(gga[0][6], "8");
}

TEST_F(Publisher, SettingsAreTakenWhileItRuns) {
  run_to(1050ms);
  NmeaConfig config;
  config.talker = "GN";
  publisher_.set_config({config, 5.0, kDatum});
  sink_.take("RMC");
  run_to(2050ms);
  const auto rmc = sink_.take("GNRMC");
  ASSERT_EQ(rmc.size(), 5U);
  EXPECT_EQ(rmc[0][1], "120001.20");
}

TEST_F(Publisher, ASinkThatIsTakenOutReceivesNoMore) {
  EpochCollector tape;
  ASSERT_TRUE(publisher_.add(tape));
  run_to(1050ms);
  publisher_.take_out(tape);
  run_to(2050ms);
  EXPECT_EQ(tape.epochs(), 1);
  EXPECT_EQ(sink_.epochs(), 2);
}

TEST_F(Publisher, TakesNoMoreSinksThanItHasRoomFor) {
  std::array<EpochCollector, NmeaPublisher::kSinksMax> more;
  for (std::size_t i = 0; i + 1 < more.size(); ++i) {
    EXPECT_TRUE(publisher_.add(more[i]));
  }
  EXPECT_FALSE(publisher_.add(more.back()));
}

TEST_F(Publisher, ItsCountersAndProblemsAreThoseOfItsSinksToo) {
  EXPECT_EQ(counter("collector_epochs"), 7U);
  EXPECT_EQ(publisher_.problem(), "");
  sink_.set_problem("unplugged");
  EXPECT_EQ(publisher_.problem(), "unplugged");
}

TEST_F(Publisher, WaitsUntilTheNextEpochButNeverLongerThanSinksMayBeLeft) {
  run_to(510ms);
  EXPECT_EQ(publisher_.wait(at(510ms)), 100ms);
  EXPECT_EQ(publisher_.wait(at(970ms)), 30ms);
}

TEST_F(Publisher, AStepAsksTheHeapForNothing) {
  if (!tests::NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: the sanitizers bring their own heap";
  }
  NmeaConfig config;
  config.zda = true;
  config.sentences.ths = true;
  publisher_.set_config({config, 10.0, kDatum});
  scan(core::FixStatus::Fix, 400ms);
  const tests::NoAllocScope scope;
  run_to(10s);
  EXPECT_EQ(scope.heap_calls(), 0U);
  EXPECT_GT(sink_.epochs(), 90);
}

}  // namespace
}  // namespace slamsensor::firmware
