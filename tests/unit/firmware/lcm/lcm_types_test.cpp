#include "tests/support/source_tree.hpp"
#include "tests/unit/firmware/lcm/sample_reports.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <unistd.h>

namespace slamsensor::firmware {
namespace {

// Reads FOLDER/package.type messages with the code that lcm-gen made; writes what it finds of some members.
constexpr const char* kReader = R"(
import pathlib, sys
folder = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(folder / 'python'))
for path in sorted(folder.glob('*.message')):
    package, name = path.stem.split('.')
    cls = getattr(__import__(package), name)
    data = path.read_bytes()
    message = cls.decode(data)
    assert message.encode() == data, path
    print(path.stem, cls._get_packed_fingerprint().hex(), len(data))
    if path.stem == 'slamsensor.pose_t':
        print(message.utime, message.scan, message.status == cls.STATUS_FIX, message.x_m, message.covariance[8],
              message.jumps, message.reason == cls.REASON_NONE, message.initialization, message.map, message.home,
              message.protection_radius_m, message.covariance_near[8], cls.REASON_COPY, cls.REASON_LOCAL_MAP,
              cls.REASON_NO_SCAN)
    if path.stem == 'slamsensor.status_t':
        print(message.device_problem[1].rstrip(b'\0').decode(), message.state == cls.STATE_FIXED, message.pan_rad,
              message.local_maps, message.local_landmarks)
    if path.stem == 'slamsensor.counters_t':
        print(message.name[2].rstrip(b'\0').decode(), message.value[2], message.station == cls.STATION_PAN_TILT)
    if path.stem == 'slamsensor.map_t':
        print(message.id[1], message.y_m[1], message.sightings[1], message.sigma_m[3], message.diameter_m[8])
    if path.stem == 'slamsensor.scan_t':
        print(message.x_m[2], message.weight[2], message.diameter_m[2], message.scan_end_monotonic_ns)
    if path.stem == 'slamsensor.rivals_t':
        print(message.count, message.y_m[1], message.matches[1])
)";

bool is_installed(const char* program) {
  return std::system(("command -v " + std::string(program) + " > /dev/null").c_str()) == 0;
}

class LcmTypes : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_installed("lcm-gen") || !is_installed("python3")) {
      GTEST_SKIP() << "lcm-gen (package liblcm-bin) or python3 is not installed: the types are not compared";
    }
    folder_ = std::filesystem::temp_directory_path() / ("lcm_types_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_ / "python");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& type, std::span<const std::uint8_t> bytes) const {
    std::ofstream(folder_ / (type + ".message"), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }

  /// What the reader says of the messages written.
  [[nodiscard]] std::string read_by_generated_code() const {
    const auto types = tests::source_tree() / "firmware/lcm/types";
    const std::string generate = "lcm-gen --python --ppath " + (folder_ / "python").string() + " " +
                                 types.string() + "/*.lcm > /dev/null";
    EXPECT_EQ(std::system(generate.c_str()), 0);
    std::ofstream(folder_ / "read.py") << kReader;
    const std::string read = "python3 " + (folder_ / "read.py").string() + " " + folder_.string() + " > " +
                             (folder_ / "out").string();
    EXPECT_EQ(std::system(read.c_str()), 0);
    std::stringstream text;
    text << std::ifstream(folder_ / "out").rdbuf();
    return text.str();
  }

  std::filesystem::path folder_;
};

template <typename T>
std::string line_of(const char* name) {
  char text[100];
  std::snprintf(text, sizeof text, "%s %016llx %zu\n", name,
                static_cast<unsigned long long>(kLcmFingerprint<T>), kLcmBytes<T>);
  return text;
}

TEST_F(LcmTypes, AreThoseOfTheLcmFiles) {
  std::array<std::uint8_t, 1400> out{};
  const SensorStatus status = tests::sample_status();
  const tests::SampleMap map(40);
  const auto landmarks = tests::sample_landmarks(3);
  write("slamsensor.pose_t", {out.data(), encode_pose(status.report, out)});
  write("bot_core.pose_t", {out.data(), encode_bot_core_pose(status.report, out)});
  write("slamsensor.status_t", {out.data(), encode_status(status, {}, out)});
  write("slamsensor.counters_t", {out.data(), encode_counters(status, {}, LcmStation::PanTilt, 0, out)});
  write("slamsensor.map_t", {out.data(), encode_map_chunk(map.view(), 0, out)});
  write("slamsensor.scan_t", {out.data(), encode_scan_chunk(tests::view_of(landmarks), 0, out)});
  write("slamsensor.rivals_t", {out.data(), encode_rivals(tests::sample_rivals(2), out)});
  EXPECT_EQ(
      read_by_generated_code(),
      line_of<BotCorePose>("bot_core.pose_t") +  //
          line_of<CountersMessage>("slamsensor.counters_t") + "resynchronised 281474976710655 True\n" +
          line_of<MapMessage>("slamsensor.map_t") + "13 -0.25 2 0.75 2.718281828459045\n" +
          line_of<PoseMessage>("slamsensor.pose_t") +
          "1752488140000000 4294967290 True 12.5 3e-05 2 True -81985529216486896 3 3 0.9 6e-06 9 10 11\n" +
          line_of<RivalsMessage>("slamsensor.rivals_t") + "2 -2.25 19\n" +
          line_of<ScanMessage>("slamsensor.scan_t") + "0.2 998.0 0.02 98765432101\n" +
          line_of<StatusMessage>("slamsensor.status_t") +
          "no reply at 115200 baud; check cable and power True -0.75 2 31\n");
}

}  // namespace
}  // namespace slamsensor::firmware
