#pragma once

#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/head_devices.hpp"
#include "tools/emulator/real_time_head.hpp"
#include "tools/emulator/scenario.hpp"

#include <atomic>
#include <ctime>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <unistd.h>
#include <utility>

namespace slamsensor::tests {

/// An emulated head that runs in real time in a thread of its own, its devices on pseudo-terminals.
class BusyHead {
 public:
  explicit BusyHead(const tools::Scenario& scenario,
                    const tools::DeviceMaker& make = tools::make_head_devices)
      : folder_(std::filesystem::temp_directory_path() / ("slamsensor-head-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    head_ = made(tools::EmulatedHead::create(scenario, make));
    tools::RealTimeConfig config;
    config.ptu = unit_path();
    config.rangefinder = finder_path();
    real_ = made(tools::RealTimeHead::create(*head_, config));
    thread_ = std::thread([this] { run(); });
  }
  BusyHead(const BusyHead&) = delete;
  BusyHead& operator=(const BusyHead&) = delete;
  ~BusyHead() {
    stop();
    real_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// From here on it is at rest.
  void stop() {
    is_stopped_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  [[nodiscard]] std::string unit_path() const { return folder_ / "ptu"; }
  [[nodiscard]] std::string finder_path() const { return folder_ / "rangefinder"; }

  /// Of a stopped head.
  [[nodiscard]] const tools::Lateness& lateness() const { return real_->lateness(); }
  [[nodiscard]] double cpu_share() const { return cpu_s_ / hal::to_seconds(head_->clock().now); }

 private:
  template <typename T>
  static T made(tl::expected<T, tools::WorldError> result) {
    if (!result) {
      throw std::runtime_error(result.error().message);
    }
    return std::move(*result);
  }

  void run() {
    tools::RealTimeHead::Orders orders;
    for (hal::Stamp end = kSlice; !is_stopped_; end += kSlice) {
      real_->run(end, orders);
    }
    timespec used{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    cpu_s_ = static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  }

  static constexpr hal::Stamp kSlice = std::chrono::milliseconds(100);

  std::filesystem::path folder_;
  std::unique_ptr<tools::EmulatedHead> head_;
  std::unique_ptr<tools::RealTimeHead> real_;
  std::atomic<bool> is_stopped_ = false;
  double cpu_s_ = 0.0;
  std::thread thread_;
};

}  // namespace slamsensor::tests
