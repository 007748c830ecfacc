#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace slamsensor::tests {

/// A folder that looks like /sys/bus/iio/devices with one accelerometer: iio:device1, whose readings are
/// 256 steps per g. Removed with all it holds at the end.
class FakeIio {
 public:
  FakeIio()
      : root_(std::filesystem::path(testing::TempDir()) /
              ("iio." + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "." +
               std::to_string(getpid()))) {
    std::filesystem::remove_all(root_);
    std::filesystem::create_directories(root_ / "iio:device0");
    write_of("iio:device0", "name", "ads1015\n");
    std::filesystem::create_directories(folder());
    write("name", "adxl345\n");
    write("in_accel_scale", "0.038307\n");
    set_raw(0, 0, 256);
  }
  FakeIio(const FakeIio&) = delete;
  FakeIio& operator=(const FakeIio&) = delete;
  ~FakeIio() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  [[nodiscard]] std::filesystem::path folder() const { return root_ / "iio:device1"; }

  void write(const std::string& file, const std::string& text) const { write_of("iio:device1", file, text); }
  void remove(const std::string& file) const { std::filesystem::remove(folder() / file); }

  void set_raw(int x, int y, int z) const {
    write("in_accel_x_raw", std::to_string(x) + '\n');
    write("in_accel_y_raw", std::to_string(y) + '\n');
    write("in_accel_z_raw", std::to_string(z) + '\n');
  }

 private:
  void write_of(const std::string& device, const std::string& file, const std::string& text) const {
    std::ofstream(root_ / device / file, std::ios::binary | std::ios::trunc) << text;
  }

  std::filesystem::path root_;
};

}  // namespace slamsensor::tests
