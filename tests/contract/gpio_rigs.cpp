// The contract of GPIO lines on the fake, and on a chip of the kernel's simulator that
// SLAMSENSOR_TEST_GPIO_CHIP names and SLAMSENSOR_TEST_GPIO_SIM is the far side of.
#include "hal/clock.hpp"
#include "hal/gpio/open_gpio.hpp"
#include "tests/contract/gpio_contract.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace slamsensor::tests {
namespace {

using testing::HasSubstr;

class FakeRig final : public GpioRig {
 public:
  hal::Stamp now() const override { return now_; }
  hal::Stamp stamping_clock() const override { return now_; }
  void pass(hal::Stamp time) override { now_ += time; }
  bool promises_no_heap() const override { return false; }

  std::unique_ptr<hal::GpioInput> input(const FakeGpioConfig& config) override {
    auto made = std::make_unique<FakeGpioInput>(config);
    input_ = made.get();
    return made;
  }
  std::unique_ptr<hal::GpioOutput> output(hal::GpioPolarity polarity, hal::GpioLevel initial) override {
    auto made = std::make_unique<FakeGpioOutput>(polarity, initial);
    output_ = made.get();
    return made;
  }
  void drive(Wire wire) override {
    if (input_ != nullptr) {
      input_->drive(wire, now_);
    }
  }
  Wire seen() override { return output_->wire(); }

 private:
  hal::Stamp now_ = std::chrono::seconds(1);
  FakeGpioInput* input_ = nullptr;
  FakeGpioOutput* output_ = nullptr;
};

/// Debouncing takes its time here, so the time of this rig is the true one.
class SimulatorRig final : public GpioRig {
 public:
  SimulatorRig(std::string chip, std::string far_side)
      : chip_(std::move(chip)), far_side_(std::move(far_side)) {}

  hal::Stamp now() const override { return hal::monotonic_now(); }
  hal::Stamp stamping_clock() const override { return hal::monotonic_now(); }
  void pass(hal::Stamp time) override { std::this_thread::sleep_for(time); }

  std::unique_ptr<hal::GpioInput> input(const FakeGpioConfig& config) override {
    return taken(
        hal::open_gpio_input({{chip_, "3"}, config.polarity, config.bias, config.edges, config.debounce}));
  }
  std::unique_ptr<hal::GpioOutput> output(hal::GpioPolarity polarity, hal::GpioLevel initial) override {
    return taken(hal::open_gpio_output({{chip_, "4"}, polarity, initial}));
  }
  void drive(Wire wire) override {
    std::ofstream pull(far_side_ + "/sim_gpio3/pull");
    pull << (wire == Wire::High ? "pull-up" : "pull-down") << std::flush;
    if (!pull) {
      throw std::runtime_error("cannot drive line 3 through " + far_side_);
    }
  }
  Wire seen() override {
    int value = -1;
    std::ifstream(far_side_ + "/sim_gpio4/value") >> value;
    EXPECT_TRUE(value == 0 || value == 1) << value;
    return value == 1 ? Wire::High : Wire::Low;
  }

 private:
  template <typename T>
  static std::unique_ptr<T> taken(tl::expected<std::unique_ptr<T>, hal::InitError> line) {
    if (!line) {
      throw std::runtime_error(line.error().message);
    }
    return std::move(*line);
  }

  std::string chip_;
  std::string far_side_;
};

MadeRig<GpioRig> make_fake_rig() {
  return std::make_unique<FakeRig>();
}

MadeRig<GpioRig> make_simulator_rig() {
  const char* const chip = std::getenv("SLAMSENSOR_TEST_GPIO_CHIP");
  const char* const far_side = std::getenv("SLAMSENSOR_TEST_GPIO_SIM");
  if (chip == nullptr || far_side == nullptr) {
    return tl::unexpected<std::string>("no simulated GPIO chip: run tests/system/run");
  }
  return std::make_unique<SimulatorRig>(chip, far_side);
}

INSTANTIATE_TEST_SUITE_P(Lines, GpioContract,
                         testing::Values(GpioRigMaker{"Fake", make_fake_rig},
                                         GpioRigMaker{"Libgpiod", make_simulator_rig}),
                         RigName());

class OpenGpio : public testing::Test {
 protected:
  void SetUp() override {
    const char* const chip = std::getenv("SLAMSENSOR_TEST_GPIO_CHIP");
    if (chip == nullptr) {
      GTEST_SKIP()
          << "SKIPPED, opening GPIO lines was NOT tested: no simulated GPIO chip: run tests/system/run";
    }
    chip_ = chip;
  }
  std::string chip_;
};

TEST_F(OpenGpio, SaysWhoHasTheLine) {
  const auto first = hal::open_gpio_output({{chip_, "5"}, {}, {}});
  ASSERT_TRUE(first) << first.error().message;
  const auto second = hal::open_gpio_output({{chip_, "5"}, {}, {}});
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("GPIO line 5 of " + chip_ + ": in use by \"slamsensor\""));
}

TEST_F(OpenGpio, GivesTheLineBack) {
  for (int i = 0; i < 3; ++i) {
    const auto line = hal::open_gpio_output({{chip_, "5"}, {}, {}});
    EXPECT_TRUE(line) << line.error().message;
  }
}

TEST_F(OpenGpio, SaysThatTheChipHasNoSuchLine) {
  for (const char* const line : {"99", "no_such_name"}) {
    const auto opened = hal::open_gpio_output({{chip_, line}, {}, {}});
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().message, HasSubstr("find the line: No such file or directory; correct"));
  }
}

}  // namespace
}  // namespace slamsensor::tests
