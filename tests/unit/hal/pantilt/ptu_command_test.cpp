#include "hal/pantilt/ptu_command.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace slamsensor::hal {
namespace {

std::string written(const PtuCommand& command) {
  std::array<std::uint8_t, kPtuCommandMax> bytes{};
  const std::size_t size = command.write(bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
}

TEST(PtuCommand, IsWrittenAsTheManualHasIt) {
  EXPECT_EQ(written(PtuCommand("V", PtuExpect::Version)), "V ");
  EXPECT_EQ(written(PtuCommand::target(Axis::Pan, -2500)), "PP-2500 ");
  EXPECT_EQ(written(PtuCommand::target(Axis::Tilt, 604)), "TP604 ");
  EXPECT_EQ(written(PtuCommand::speed(Axis::Pan, 1000)), "PS1000 ");
  EXPECT_EQ(written(PtuCommand::query(Axis::Tilt, PtuQuantity::MinPosition)), "TN ");
  EXPECT_EQ(written(PtuCommand::query(Axis::Pan, PtuQuantity::Resolution)), "PR ");
  EXPECT_EQ(written(PtuCommand::baud(38400)), "@(38400,0,F) ");
  EXPECT_EQ(written(PtuCommand::baud(std::numeric_limits<std::uint32_t>::max())), "@(4294967295,0,F) ");
  EXPECT_EQ(written(PtuCommand::target(Axis::Pan, std::numeric_limits<std::int32_t>::min())),
            "PP-2147483648 ");
}

TEST(PtuCommand, DoesNotWriteWhatHasNoRoom) {
  std::array<std::uint8_t, 3> bytes{};
  EXPECT_EQ(PtuCommand::target(Axis::Pan, 100).write(bytes), 0U);
}

TEST(PtuMatch, TakesNumbersForPositionsOnlyWhenWhole) {
  const PtuCommand query = PtuCommand::query(Axis::Pan, PtuQuantity::Position);
  EXPECT_EQ(ptu_match(query, "22")->value, 22.0);
  EXPECT_FALSE(ptu_match(query, "22")->verbose);
  EXPECT_TRUE(ptu_match(query, "Current Pan position is 22")->verbose);
  for (const char* payload : {"", "185.1428", "Current Tilt position is 22", "Minimum Pan position is -3090",
                              "independent (default) speed control mode", "12* 13"}) {
    EXPECT_FALSE(ptu_match(query, payload)) << payload;
  }
}

TEST(PtuMatch, KeepsTheKindsOfAnswersApart) {
  const PtuCommand move = PtuCommand::target(Axis::Pan, 5);
  EXPECT_TRUE(ptu_match(move, ""));
  EXPECT_FALSE(ptu_match(move, "22"));
  const PtuCommand setting("FT", PtuExpect::Setting);
  EXPECT_TRUE(ptu_match(setting, ""));
  EXPECT_TRUE(ptu_match(setting, "ASCII terse mode"));
  EXPECT_FALSE(ptu_match(setting, "22"));
  const PtuCommand version("V", PtuExpect::Version);
  EXPECT_TRUE(ptu_match(version, "v3.3.0"));
  EXPECT_FALSE(ptu_match(version, ""));
  EXPECT_FALSE(ptu_match(version, "22"));
}

}  // namespace
}  // namespace slamsensor::hal
