#include "hal/gpio/open_gpio.hpp"

#include <gmock/gmock.h>

namespace slamsensor::hal {
namespace {

using testing::HasSubstr;

TEST(OpenGpio, SaysThatThereIsNoSuchChip) {
  const auto input = open_gpio_input({{"/dev/gpiochip_none", "17"}, {}, {}, {}, {}});
  ASSERT_FALSE(input);
  EXPECT_THAT(
      input.error().message,
      HasSubstr("GPIO line 17 of /dev/gpiochip_none: open the chip: No such file or directory; correct"));
}

TEST(OpenGpio, SaysThatTheFileIsNoChip) {
  const auto output = open_gpio_output({{"/dev/null", "PPS_IN"}, {}, {}});
  ASSERT_FALSE(output);
  EXPECT_THAT(output.error().message, HasSubstr("GPIO line PPS_IN of /dev/null: open the chip: "));
  EXPECT_THAT(output.error().message, HasSubstr("this is no GPIO chip"));
}

TEST(OpenGpio, RefusesAnImpossibleDebounceTime) {
  for (const Stamp debounce : {Stamp(-1), Stamp(std::chrono::milliseconds(1001))}) {
    const auto input = open_gpio_input({{"/dev/gpiochip0", "1"}, {}, {}, {}, debounce});
    ASSERT_FALSE(input);
    EXPECT_THAT(input.error().message, HasSubstr("within 0 to 1 s"));
  }
}

TEST(OpenGpio, DistinguishesAnOffsetFromAName) {
  EXPECT_EQ(offset_of({"", "17"}), 17U);
  EXPECT_EQ(offset_of({"", "0"}), 0U);
  for (const char* const name : {"", "PPS", "17a", "-1", " 1", "99999999999"}) {
    EXPECT_EQ(offset_of({"", name}), std::nullopt) << name;
  }
}

}  // namespace
}  // namespace slamsensor::hal
