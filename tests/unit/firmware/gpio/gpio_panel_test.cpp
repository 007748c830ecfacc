#include "firmware/gpio/gpio_panel.hpp"

#include "tests/support/fake_gpio.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using tests::FakeGpioInput;
using tests::FakeGpioOutput;
using tests::Wire;

/// Lines by their number, as a panel asked for them; numbers in `missing` do not exist.
struct FakeChip {
  std::map<std::string, FakeGpioInput*> inputs;
  std::map<std::string, FakeGpioOutput*> outputs;
  std::map<std::string, hal::GpioInputConfig> asked;
  std::string missing;

  GpioOpeners openers() {
    return {[this](const hal::GpioInputConfig& config) { return input(config); },
            [this](const hal::GpioOutputConfig& config) { return output(config); }};
  }

 private:
  tl::expected<std::unique_ptr<hal::GpioInput>, hal::InitError> input(const hal::GpioInputConfig& config) {
    if (config.address.line == missing) {
      return tl::unexpected(hal::gpio_error(config.address, "no such line"));
    }
    auto line = std::make_unique<FakeGpioInput>(
        tests::FakeGpioConfig{config.polarity, config.bias, config.edges, config.debounce});
    inputs[config.address.line] = line.get();
    asked[config.address.line] = config;
    return line;
  }
  tl::expected<std::unique_ptr<hal::GpioOutput>, hal::InitError> output(const hal::GpioOutputConfig& config) {
    if (config.address.line == missing) {
      return tl::unexpected(hal::gpio_error(config.address, "no such line"));
    }
    auto line = std::make_unique<FakeGpioOutput>(config.polarity, config.initial);
    outputs[config.address.line] = line.get();
    return line;
  }
};

constexpr const char* kChip = "/dev/gpiochip7";

GpioConfig all_lines() {
  GpioConfig config;
  config.trigger = {kChip, 1, GpioPolaritySetting::ActiveLow, GpioBiasSetting::PullUp, 0.005};
  config.interlock = {kChip, 2, GpioPolaritySetting::ActiveHigh, GpioBiasSetting::PullDown, 0.002};
  config.led = {kChip, 3, GpioPolaritySetting::ActiveHigh};
  config.pulse = {kChip, 4, GpioPolaritySetting::ActiveLow};
  config.pulse_s = 0.1;
  return config;
}

class GpioPanelTest : public testing::Test {
 protected:
  void SetUp() override {
    auto made = GpioPanel::open(all_lines(), chip_.openers());
    ASSERT_TRUE(made) << made.error().message;
    panel_ = std::move(*made);
  }
  Wire led() const { return chip_.outputs.at("3")->wire(); }
  Wire pulse() const { return chip_.outputs.at("4")->wire(); }  // active low
  GpioInputs& inputs() { return panel_->inputs(); }
  GpioOutputs& outputs() { return panel_->outputs(); }

  FakeChip chip_;
  std::unique_ptr<GpioPanel> panel_;
};

TEST_F(GpioPanelTest, LinesAreAskedForAsConfigured) {
  const hal::GpioInputConfig& trigger = chip_.asked.at("1");
  EXPECT_EQ(trigger.address.chip, kChip);
  EXPECT_EQ(trigger.polarity, hal::GpioPolarity::ActiveLow);
  EXPECT_EQ(trigger.bias, hal::GpioBias::PullUp);
  EXPECT_EQ(trigger.edges, hal::GpioEdges::ToActive);
  EXPECT_EQ(trigger.debounce, 5ms);
  EXPECT_EQ(chip_.asked.at("2").edges, hal::GpioEdges::Both);
  EXPECT_EQ(led(), Wire::Low);
  EXPECT_EQ(pulse(), Wire::High) << "inactive at start";
}

TEST_F(GpioPanelTest, ATriggerIsOneRequestHoweverItBounces) {
  FakeGpioInput& trigger = *chip_.inputs.at("1");
  EXPECT_FALSE(inputs().poll(1s).scan_wanted);
  for (int i = 0; i < 5; ++i) {
    trigger.drive(i % 2 == 0 ? Wire::Low : Wire::High, 1s + i * 1ms);
  }
  EXPECT_FALSE(inputs().poll(1s + 8ms).scan_wanted) << "it has not kept its level for 5 ms yet";
  EXPECT_TRUE(inputs().poll(1s + 10ms).scan_wanted);
  EXPECT_FALSE(inputs().poll(1s + 11ms).scan_wanted);
  trigger.drive(Wire::High, 2s);
  EXPECT_FALSE(inputs().poll(3s).scan_wanted) << "letting go asks for nothing";
  trigger.drive(Wire::Low, 4s);
  EXPECT_TRUE(inputs().poll(5s).scan_wanted);
  EXPECT_EQ(inputs().count(GpioInputEvent::TriggerEdges), 2U);
}

TEST_F(GpioPanelTest, TheInterlockAllowsScanningWhileItIsActive) {
  FakeGpioInput& interlock = *chip_.inputs.at("2");
  EXPECT_TRUE(inputs().poll(1s).interlock_open);
  interlock.drive(Wire::High, 2s);
  EXPECT_TRUE(inputs().poll(2s + 1ms).interlock_open) << "not settled yet";
  EXPECT_FALSE(inputs().poll(2s + 2ms).interlock_open);
  interlock.drive(Wire::Low, 3s);
  EXPECT_TRUE(inputs().poll(3s + 2ms).interlock_open);
  EXPECT_EQ(inputs().count(GpioInputEvent::InterlockOpenings), 2U);
}

TEST_F(GpioPanelTest, AnOpeningBetweenTwoPollsIsSeen) {
  FakeGpioInput& interlock = *chip_.inputs.at("2");
  interlock.drive(Wire::High, 1s);
  EXPECT_FALSE(inputs().poll(1s + 5ms).interlock_open);
  interlock.drive(Wire::Low, 2s);
  interlock.drive(Wire::High, 2s + 10ms);
  EXPECT_TRUE(inputs().poll(2s + 20ms).interlock_open);
  EXPECT_FALSE(inputs().poll(2s + 21ms).interlock_open);
}

TEST_F(GpioPanelTest, AnInterlockThatCannotBeReadIsOpen) {
  FakeGpioInput& interlock = *chip_.inputs.at("2");
  interlock.drive(Wire::High, 1s);
  EXPECT_FALSE(inputs().poll(2s).interlock_open);
  interlock.remove_chip();
  chip_.inputs.at("1")->remove_chip();
  const GpioOrders orders = inputs().poll(3s);
  EXPECT_TRUE(orders.interlock_open);
  EXPECT_FALSE(orders.scan_wanted);
  EXPECT_EQ(inputs().count(GpioInputEvent::InterlockLost), 1U);
}

TEST_F(GpioPanelTest, TheLedShowsTheState) {
  const std::vector<std::pair<SensorState, Wire>> steady = {{SensorState::Fixed, Wire::High},
                                                            {SensorState::Ambiguous, Wire::Low},
                                                            {SensorState::Lost, Wire::Low},
                                                            {SensorState::Scanning, Wire::Low}};
  for (const auto& [state, wire] : steady) {
    for (hal::Stamp now = 10s; now < 11s; now += 10ms) {
      outputs().step(state, now);
      ASSERT_EQ(led(), wire) << kSensorStateNames[static_cast<std::size_t>(state)];
    }
    EXPECT_EQ(outputs().next_change(11s), hal::kNever);
  }
}

TEST_F(GpioPanelTest, TheLedBlinksWithoutDevicesAndFasterWhenHeld) {
  const std::vector<std::pair<SensorState, int>> blinking = {
      {SensorState::Starting, 1}, {SensorState::Faulted, 1}, {SensorState::Held, 4}};
  for (const auto& [state, rate_hz] : blinking) {
    int changes = 0;
    outputs().step(state, 20s - 10ms);
    Wire before = led();
    for (hal::Stamp now = 20s; now < 30s; now += 10ms) {
      outputs().step(state, now);
      changes += led() != before ? 1 : 0;
      before = led();
    }
    EXPECT_EQ(changes, 2 * 10 * rate_hz) << kSensorStateNames[static_cast<std::size_t>(state)];
    EXPECT_EQ(outputs().next_change(30s), 30s + 500ms / rate_hz);
  }
}

TEST_F(GpioPanelTest, AFixGivesAPulse) {
  outputs().step(SensorState::Fixed, 1s);
  EXPECT_EQ(pulse(), Wire::High);
  outputs().on_fix(2s);
  EXPECT_EQ(pulse(), Wire::Low) << "at once";
  EXPECT_EQ(outputs().next_change(2s), 2s + 100ms);
  outputs().step(SensorState::Fixed, 2s + 99ms);
  EXPECT_EQ(pulse(), Wire::Low);
  outputs().step(SensorState::Fixed, 2s + 100ms);
  EXPECT_EQ(pulse(), Wire::High);
  outputs().on_fix(3s);
  outputs().on_fix(3s + 60ms);
  outputs().step(SensorState::Fixed, 3s + 120ms);
  EXPECT_EQ(pulse(), Wire::Low) << "the second fix made it longer";
  outputs().step(SensorState::Fixed, 3s + 160ms);
  EXPECT_EQ(pulse(), Wire::High);
  EXPECT_EQ(outputs().count(GpioOutputEvent::PulsesBegun), 2U);
  EXPECT_EQ(outputs().count(GpioOutputEvent::PulsesJoined), 1U);
}

TEST_F(GpioPanelTest, AnOutputThatFailsIsCountedAndTheOtherWorksOn) {
  chip_.outputs.at("3")->remove_chip();
  outputs().step(SensorState::Fixed, 1s);
  outputs().on_fix(1s);
  EXPECT_EQ(pulse(), Wire::Low);
  EXPECT_EQ(outputs().count(GpioOutputEvent::LedFailed), 1U);
  EXPECT_EQ(outputs().count(GpioOutputEvent::PulseFailed), 0U);
}

TEST(GpioPanelOpen, ALineThatIsNotThereIsReportedWithItsSetting) {
  const std::vector<std::pair<std::string, std::string>> lines = {
      {"1", "gpio.trigger"}, {"2", "gpio.interlock"}, {"3", "gpio.led"}, {"4", "gpio.pulse"}};
  for (const auto& [line, setting] : lines) {
    FakeChip chip;
    chip.missing = line;
    const auto made = GpioPanel::open(all_lines(), chip.openers());
    ASSERT_FALSE(made) << setting;
    EXPECT_NE(made.error().message.find(setting), std::string::npos) << made.error().message;
    EXPECT_NE(made.error().message.find("line " + line + " of " + kChip), std::string::npos)
        << made.error().message;
  }
}

TEST(GpioPanelOpen, TheKernelsChipThatIsNotThereIsReportedToo) {
  GpioConfig config;
  config.interlock.chip = "/dev/no-such-gpiochip";
  const auto made = GpioPanel::open(config);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message.find("gpio.interlock"), std::string::npos) << made.error().message;
  EXPECT_NE(made.error().message.find("no-such-gpiochip"), std::string::npos) << made.error().message;
}

TEST(GpioPanelOpen, WithoutLinesNothingIsAskedForAndNothingHolds) {
  FakeChip chip;
  const auto made = GpioPanel::open({}, chip.openers());
  ASSERT_TRUE(made);
  EXPECT_TRUE(chip.asked.empty());
  const GpioOrders orders = (*made)->inputs().poll(1s);
  EXPECT_FALSE(orders.scan_wanted);
  EXPECT_FALSE(orders.interlock_open);
  (*made)->outputs().on_fix(1s);
  (*made)->outputs().step(SensorState::Held, 1s);
  EXPECT_EQ((*made)->outputs().next_change(1s), hal::kNever);
}

}  // namespace
}  // namespace slamsensor::firmware
