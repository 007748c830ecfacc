// What check-config accepts, the daemon starts with: every corner of every setting, for each kind of head.

#include "core/slam.hpp"
#include "firmware/config/load_config.hpp"
#include "firmware/daemon/sensor_threads.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fcntl.h>
#include <string>
#include <variant>
#include <vector>

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kMemoryMax_bytes = std::size_t{256}
                                         << 20;  // larger ones are no question of the settings

/// Values at the ends of what a setting allows, as an assignment writes them.
struct Corners {
  std::vector<std::string> operator()(const RealSetting& s) const {
    return {real_text(s.min), std::isfinite(s.max) ? real_text(s.max) : "inf"};
  }
  std::vector<std::string> operator()(const DurationSetting& s) const {
    return {real_text(s.min_s), real_text(s.max_s)};
  }
  std::vector<std::string> operator()(const IntegerSetting& s) const {
    if (s.only.empty()) {
      return {std::to_string(s.min), std::to_string(s.max)};
    }
    std::vector<std::string> all;
    for (const std::uint32_t value : s.only) {
      all.push_back(std::to_string(value));
    }
    return all;
  }
  std::vector<std::string> operator()(const BooleanSetting&) const { return {"true", "false"}; }
  std::vector<std::string> operator()(const ChoiceSetting& s) const {
    return {s.names.begin(), s.names.end()};
  }
  std::vector<std::string> operator()(const TextSetting& s) const { return {s.names.begin(), s.names.end()}; }
  /// What one or another text of the settings may be; what a rule does not take is left out later.
  std::vector<std::string> operator()(const FreeTextSetting&) const {
    return {"",
            "x",
            "/",
            "/dev/null",
            "/" + std::string(106, 'x'),
            "/" + std::string(159, 'x'),
            std::string(63, 'x'),
            std::string(48, 'x'),
            std::string(15, 'x'),
            "127.0.0.1",
            "::",
            "memq://",
            "udpm://239.255.76.67:7667?ttl=0",
            "udpm://:1",
            "udpm://239.255.255.255:65535?ttl=255&recv_buf_size=1073741824",
            "udpm://239.255.76.67:7667?ttl=256",
            "udpm://1.2.3.4:7667",
            "tcpq://",
            "file:///tmp/x"};
  }
  std::vector<std::string> operator()(const IntegerListSetting& s) const {
    std::string longest = "[";
    for (std::size_t i = 0; i < s.items.max; ++i) {
      longest += (i == 0 ? "" : ", ") + std::to_string(s.max);
    }
    return {"[" + std::to_string(s.min) + "]", longest + "]"};
  }
  std::vector<std::string> operator()(const TextListSetting&) const {
    return {"RMC", "PSLMA", "1=none", "x=weak"};
  }
};

std::size_t memory_bytes(const Config& config) {
  std::size_t bytes = 0;
  static_cast<void>(core::plan_memory(config.core, bytes));
  return bytes;
}

class AcceptedSettings : public testing::TestWithParam<std::vector<Assignment>> {};

TEST_P(AcceptedSettings, AreThoseThatTheDaemonStartsWith) {
  const int null = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  Log log({.fd = null});
  std::size_t started = 0;
  for (const Setting& setting : settings()) {
    if (setting.section() == "gpio" && setting.key().ends_with("_chip")) {
      continue;  // which chips there are, is the machine's affair
    }
    for (const std::string& value : std::visit(Corners(), setting.kind)) {
      LoadedConfig loaded;
      std::vector<Assignment> assignments = GetParam();
      assignments.push_back({std::string(setting.path), value});
      std::vector<ConfigError> errors = apply_assignments(loaded, assignments, "test");
      append(errors, check_config(loaded, errors));
      if (!errors.empty() || memory_bytes(loaded.config) > kMemoryMax_bytes) {
        continue;
      }
      const auto threads = SensorThreads::create(loaded.config, {}, log);
      EXPECT_TRUE(threads) << setting.path << " = " << value << ": " << threads.error();
      ++started;
    }
  }
  EXPECT_GT(started, settings().size());
  ::close(null);
}

std::vector<Assignment> head(const std::string& pan_tilt, const std::string& rangefinder) {
  return {{"head.pan_tilt", pan_tilt},
          {"head.rangefinder", rangefinder},
          {"nmea.serial_path", "/dev/slamsensor/none"},
          {"nmea.tcp", "true"},
          {"capacities.map_landmarks", "200"},
          {"capacities.map_edges", "3000"},
          {"capacities.path_poses", "100"}};
}

INSTANTIATE_TEST_SUITE_P(Heads, AcceptedSettings,
                         testing::Values(head("ptu", "lwnx"), head("ptu", "point_laser"),
                                         head("ptu", "benewake_serial"), head("canopen", "benewake_can")));

}  // namespace
}  // namespace slamsensor::firmware
