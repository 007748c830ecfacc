// A CiA 402 node spoken to in frames as hosts send them.
#include "tests/unit/tools/emulator/canopen/canopen_rig.hpp"

#include <gtest/gtest.h>

namespace slamsensor::tools {
namespace {

using namespace std::chrono_literals;

std::string word(const std::string& value) {
  return "601 2B 40 60 00 " + value + " 00 00";
}

const char* const kStatus = "601 40 41 60 00 00 00 00 00";

std::string status(const std::string& value) {
  return "581 4B 41 60 00 " + value + " 00 00";
}

void enable(DriveRig& rig) {
  for (const char* value : {"06 00", "07 00", "0F 00"}) {
    EXPECT_EQ(rig.ask(word(value)), "581 60 40 60 00 00 00 00 00");
  }
}

TEST(EmulatedDrive, BootsAndObeysNmt) {
  DriveRig rig{DriveSettings{}};
  rig.pass(499ms);
  EXPECT_EQ(rig.heard(), "");
  rig.pass(1ms);
  EXPECT_EQ(rig.heard(), "701 00");
  EXPECT_EQ(rig.ask("601 2B 17 10 00 64 00 00 00", 50ms), "701 7F | 581 60 17 10 00 00 00 00 00");
  EXPECT_EQ(rig.ask("000 01 02", 60ms), "701 7F");  // another node
  EXPECT_EQ(rig.ask("000 02 00", 100ms), "701 04");
  EXPECT_EQ(rig.ask(kStatus), "");  // stopped: no SDO
  EXPECT_EQ(rig.ask("000 80 00"), "");
  EXPECT_EQ(rig.ask(kStatus), status("50 02"));
  EXPECT_EQ(rig.ask("000 82 01"), "701 00");
  EXPECT_EQ(rig.ask("000 81 01", 600ms), "701 00");
}

TEST(EmulatedDrive, AnswersTheManualsExamples) {
  DriveRig rig(DriveRig::ready());
  const char* const kExamples[][2] = {
      {"601 2F 60 60 00 01 00 00 00", "581 60 60 60 00 00 00 00 00"},
      {"601 2F 60 60 00 03 00 00 00", "581 60 60 60 00 00 00 00 00"},
      {"601 2F 60 60 00 06 00 00 00", "581 60 60 60 00 00 00 00 00"},
      {"601 23 7A 60 00 58 9E FF FF", "581 60 7A 60 00 00 00 00 00"},
      {"601 23 81 60 00 10 27 00 00", "581 60 81 60 00 00 00 00 00"},
      {"601 23 FF 60 00 F0 D8 FF FF", "581 60 FF 60 00 00 00 00 00"},
      {"601 40 64 60 00 00 00 00 00", "581 43 64 60 00 00 00 00 00"},
      {"601 40 7A 60 00 00 00 00 00", "581 43 7A 60 00 58 9E FF FF"},
      {"601 40 00 20 00 00 00 00 00", "581 80 00 20 00 00 00 02 06"},
      {"601 40 18 10 09 00 00 00 00", "581 80 18 10 09 11 00 09 06"},
      {"601 2B 41 60 00 00 00 00 00", "581 80 41 60 00 02 00 01 06"},
      {"601 2B 60 60 00 01 00 00 00", "581 80 60 60 00 12 00 07 06"},
      {"601 2B 81 60 00 01 00 00 00", "581 80 81 60 00 13 00 07 06"},
      {"601 2F 60 60 00 04 00 00 00", "581 80 60 60 00 30 00 09 06"},
      {"601 23 81 60 00 FF FF FF 7F", "581 80 81 60 00 31 00 09 06"},
      {"601 23 83 60 00 00 00 00 00", "581 80 83 60 00 32 00 09 06"},
      {"601 23 7D 60 02 00 00 00 80", "581 80 7D 60 02 36 00 09 06"},
      {"601 A0 41 60 00 00 00 00 00", "581 80 41 60 00 01 00 04 05"},
      {"601 40 03 10 01 00 00 00 00", "581 80 03 10 01 24 00 00 08"},
  };
  for (const auto& example : kExamples) {
    EXPECT_EQ(rig.ask(example[0]), example[1]) << example[0];
  }
}

TEST(EmulatedDrive, SendsItsNameInSegments) {
  DriveRig rig(DriveRig::ready());
  EXPECT_EQ(rig.ask("601 40 08 10 00 00 00 00 00"), "581 41 08 10 00 15 00 00 00");
  EXPECT_EQ(rig.ask("601 60 00 00 00 00 00 00 00"), "581 00 43 69 41 20 34 30 32");
  EXPECT_EQ(rig.ask("601 70 00 00 00 00 00 00 00"), "581 10 20 70 61 6E 2D 74 69");
  EXPECT_EQ(rig.ask("601 70 00 00 00 00 00 00 00"), "581 80 08 10 00 00 00 03 05");
  EXPECT_EQ(rig.ask("601 60 00 00 00 00 00 00 00").substr(0, 6), "581 80");
}

TEST(EmulatedDrive, WalksThroughItsStates) {
  DriveRig rig(DriveRig::ready());
  rig.ask("601 2F 60 60 00 01 00 00 00");
  const char* const kWalk[][2] = {{"07 00", "50 02"}, {"06 00", "31 02"}, {"07 00", "33 02"},
                                  {"0F 00", "37 06"}, {"07 00", "33 02"}, {"0F 00", "37 06"},
                                  {"06 00", "31 02"}, {"00 00", "50 02"}, {"06 00", "31 02"},
                                  {"0F 00", "37 06"}, {"02 00", "50 02"}};
  for (const auto& leg : kWalk) {
    rig.ask(word(leg[0]));
    EXPECT_EQ(rig.ask(kStatus), status(leg[1])) << "after " << leg[0];
  }
}

TEST(EmulatedDrive, MovesToSetPointsByPdo) {
  DriveRig rig(DriveRig::ready());
  const char* const kMap[] = {
      "601 23 00 14 01 01 02 00 80", "601 2F 00 16 00 00 00 00 00", "601 23 00 16 01 10 00 40 60",
      "601 23 00 16 02 20 00 7A 60", "601 2F 00 16 00 02 00 00 00", "601 2F 00 14 02 FF 00 00 00",
      "601 23 00 14 01 01 02 00 00", "601 23 00 18 01 81 01 00 80", "601 2F 00 1A 00 00 00 00 00",
      "601 23 00 1A 01 10 00 41 60", "601 23 00 1A 02 20 00 64 60", "601 2F 00 1A 00 02 00 00 00",
      "601 2F 00 18 02 01 00 00 00", "601 23 00 18 01 81 01 00 00", "601 23 01 18 01 81 02 00 80",
      "601 23 02 18 01 81 03 00 80", "601 2F 60 60 00 01 00 00 00", "601 23 81 60 00 10 27 00 00"};
  for (const char* const write : kMap) {
    EXPECT_EQ(rig.ask(write).substr(0, 6), "581 60") << write;
  }
  EXPECT_EQ(rig.ask("601 2F 00 1A 00 00 00 00 00"), "581 80 00 1A 00 00 00 01 06");
  enable(rig);
  EXPECT_EQ(rig.ask("080"), "");  // pre-operational
  rig.ask("000 01 01");
  EXPECT_EQ(rig.ask("080"), "181 37 06 00 00 00 00");
  EXPECT_EQ(rig.ask("201 1F 00 58 9E FF FF"), "");
  EXPECT_EQ(rig.ask("080").substr(0, 9), "181 37 12");
  const Stamp begun = rig.now - 4ms;
  rig.host("201 0F 00 58 9E FF FF");
  // 25,000 counts at 10,000 counts/s and 1,137,778 counts/s^2.
  const Stamp end = begun + hal::from_seconds(25'000.0 / 10'000.0 + 10'000.0 / 1'137'778.0);
  rig.pass(end - 1us - rig.now);
  EXPECT_EQ(rig.ask("080", 100us).substr(0, 9), "181 37 02");
  EXPECT_EQ(rig.ask("080"), "181 37 06 58 9E FF FF");
  EXPECT_NEAR(rig.drive.angle_rad(rig.now), -25'000.0 / rig.ready().counts_per_rad(), 1e-12);
}

TEST(EmulatedDrive, LatchesPositionAtSync) {
  DriveRig rig(DriveRig::ready());
  for (const char* const write :
       {"601 2F 60 60 00 03 00 00 00", "601 23 FF 60 00 10 27 00 00", "601 2F 01 18 02 01 00 00 00",
        "601 23 00 18 01 81 01 00 80", "601 23 02 18 01 81 03 00 80"}) {
    rig.ask(write);
  }
  enable(rig);
  rig.ask("000 01 00", 100ms);
  const auto counts =
      static_cast<std::uint32_t>(std::llround(rig.drive.angle_rad(rig.now) * rig.ready().counts_per_rad()));
  const Stamp sync = rig.now;
  char text[32];
  std::snprintf(text, sizeof text, "281 37 06 %02X %02X 00 00", counts & 255U, counts >> 8U);
  EXPECT_EQ(rig.ask("080"), text);
  EXPECT_EQ(rig.times.at(0), sync + 50us);
}

TEST(EmulatedDrive, ReportsAChangeOfStatusByEvent) {
  DriveRig rig(DriveRig::ready());
  rig.ask("601 2F 60 60 00 03 00 00 00");
  EXPECT_EQ(rig.ask("000 01 01"), "181 50 02 | 281 50 02 00 00 00 00 | 381 50 02 00 00 00 00");
  EXPECT_EQ(rig.ask("201 06 00"), "181 31 02 | 281 31 02 00 00 00 00 | 381 31 02 00 00 00 00");
}

TEST(EmulatedDrive, StopsAtItsLimits) {
  DriveRig rig(DriveRig::ready());
  rig.ask("601 2F 60 60 00 01 00 00 00");
  rig.ask("601 23 81 60 00 55 35 05 00");
  rig.ask("601 23 7A 60 00 00 00 00 10");
  enable(rig);
  rig.ask(word("1F 00"), 1s);
  EXPECT_EQ(rig.ask(kStatus), status("37 1E"));
  EXPECT_EQ(rig.ask("601 40 64 60 00 00 00 00 00"), "581 43 64 60 00 1C C7 02 00");
}

TEST(EmulatedDrive, FindsHome) {
  for (const char* const method : {"11", "12", "23", "25"}) {
    DriveSettings settings = DriveRig::ready();
    settings.memory = DriveMemory::Incremental;
    settings.start = 1000;
    DriveRig rig(settings);
    rig.ask("601 2F 60 60 00 06 00 00 00");
    rig.ask(std::string("601 2F 98 60 00 ") + method + " 00 00 00");
    rig.ask("601 23 7C 60 00 40 E2 01 00");
    enable(rig);
    EXPECT_EQ(rig.ask(kStatus), status("37 06"));
    rig.ask(word("1F 00"), 15s);
    EXPECT_EQ(rig.ask(kStatus), status("37 16")) << method;
    EXPECT_EQ(rig.ask("601 40 64 60 00 00 00 00 00"), "581 43 64 60 00 40 E2 01 00") << method;
    const double truth = rig.drive.angle_rad(rig.now) * settings.counts_per_rad();
    const std::string name = method;
    const double edge = static_cast<double>(settings.upper_limit + settings.switch_margin);
    if (name == "11" || name == "12") {
      EXPECT_NEAR(truth, name == "11" ? -edge : edge, 1e-3);
    } else {
      EXPECT_NEAR(truth, 1000.0, 1e-6);
    }
  }
}

TEST(EmulatedDrive, SaysThatItIsHomedAsLongAsItKnowsItsPlace) {
  for (const DriveMemory memory : {DriveMemory::Absolute, DriveMemory::Incremental}) {
    DriveSettings settings = DriveRig::ready();
    settings.memory = memory;
    DriveRig rig(settings);
    rig.ask("601 2F 60 60 00 06 00 00 00");
    enable(rig);
    EXPECT_EQ(rig.ask(kStatus), status(memory == DriveMemory::Absolute ? "37 16" : "37 06"));
    rig.ask("601 2F 98 60 00 25 00 00 00");
    rig.ask(word("1F 00"), 1s);
    EXPECT_EQ(rig.ask(kStatus), status("37 16"));
    rig.ask("601 2F 60 60 00 01 00 00 00");
    rig.ask("601 2F 60 60 00 06 00 00 00");
    EXPECT_EQ(rig.ask(kStatus), status("37 16"));
  }
}

TEST(EmulatedDrive, FailsAndRecovers) {
  DriveRig rig(DriveRig::ready());
  rig.ask("601 2F 60 60 00 03 00 00 00");
  rig.ask("601 23 FF 60 00 F0 D8 FF FF");
  enable(rig);
  rig.pass(100ms);
  rig.frames.clear();
  EXPECT_TRUE(rig.drive.inject({FaultKind::Emergency, rig.now, 50ms}));
  EXPECT_EQ(rig.drive.drive_state(), PowerState::FaultReaction);
  rig.pass(10ms);
  EXPECT_EQ(rig.heard(), "081 10 23 03 00 00 00 00 00");
  EXPECT_EQ(rig.ask(kStatus), status("18 02"));
  rig.ask(word("80 00"));
  EXPECT_EQ(rig.ask(kStatus), status("18 02"));  // still there
  rig.ask(word("00 00"), 50ms);
  EXPECT_EQ(rig.ask(word("80 00")), "081 00 00 00 00 00 00 00 00 | 581 60 40 60 00 00 00 00 00");
  EXPECT_EQ(rig.ask(kStatus), status("50 02"));
  EXPECT_EQ(rig.ask("601 40 03 10 01 00 00 00 00"), "581 43 03 10 01 10 23 00 00");
  enable(rig);
  rig.pass(100ms);
  rig.frames.clear();
  EXPECT_TRUE(rig.drive.inject({FaultKind::MissedSteps, rig.now, 0ns}));
  rig.pass(49ms);
  EXPECT_EQ(rig.heard(), "");
  rig.pass(2ms);  // 500 counts at 10,000 counts/s
  EXPECT_EQ(rig.heard(), "081 11 86 21 00 00 00 00 00");
}

TEST(EmulatedDrive, KnowsItsFaults) {
  DriveRig rig(DriveRig::ready());
  const auto inject = [&](FaultKind kind, Stamp time) { return rig.drive.inject({kind, rig.now, time}); };
  EXPECT_FALSE(inject(FaultKind::DropByte, 0ns));
  EXPECT_TRUE(inject(FaultKind::SdoAbort, 0ns));
  EXPECT_EQ(rig.ask(kStatus), "581 80 41 60 00 00 00 00 08");
  EXPECT_TRUE(inject(FaultKind::SdoSilence, 0ns));
  EXPECT_EQ(rig.ask(kStatus), "");
  EXPECT_EQ(rig.ask(kStatus), status("50 02"));
  EXPECT_TRUE(inject(FaultKind::Silence, 10ms));
  EXPECT_EQ(rig.ask(kStatus, 10ms), "");
  rig.ask("601 2B 17 10 00 0A 00 00 00");
  EXPECT_TRUE(inject(FaultKind::HeartbeatLost, 50ms));
  EXPECT_EQ(rig.ask(kStatus, 45ms), status("50 02"));
  rig.pass(20ms);
  EXPECT_TRUE(inject(FaultKind::NodeReset, 0ns));
  EXPECT_EQ(rig.ask(kStatus, 2s), "701 00");
  EXPECT_TRUE(inject(FaultKind::PowerCycle, 1s));
  EXPECT_EQ(rig.ask(kStatus, 1499ms), "");
  rig.pass(1ms);
  EXPECT_EQ(rig.heard(), "701 00");
}

}  // namespace
}  // namespace slamsensor::tools
