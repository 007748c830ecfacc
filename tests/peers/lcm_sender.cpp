// A sensor's outputs on command, for real readers: LCM by LcmPublisher, NMEA by NmeaTcpServer. Says the TCP
// port first. Each line on its standard input is a command: "warm" sends a pose that says no_fix; "send N"
// sends N poses and, with every tenth, scan, status and map, and says for each pose the line that a reader
// must print.
#include "firmware/lcm/lcm_publisher.hpp"
#include "firmware/output/nmea.hpp"
#include "firmware/serving/nmea_tcp_server.hpp"
#include "hal/clock.hpp"
#include "tests/unit/firmware/lcm/sample_reports.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>

namespace slamsensor::tests {
namespace {

using namespace firmware;

// Rates that LCM's own tools keep up with.
constexpr auto kBetweenPoses = std::chrono::milliseconds(3);

/// Pose number `i`, in whole millimetres, hundredths of a degree and of a second.
FixReport report_of(int i) {
  FixReport report = sample_report();
  core::Fix& fix = report.fix;
  fix.scan = static_cast<std::uint32_t>(i);
  fix.time.middle_utc = std::chrono::seconds(1'752'488'130) + std::chrono::milliseconds(250 * i);
  fix.pose_W = {0.123 * i - 20.0, 7.5 - 0.077 * i, (-179.0 + 1.37 * i) * M_PI / 180.0};
  fix.pose_W.heading_rad = core::wrap_angle(fix.pose_W.heading_rad);
  fix.map = static_cast<std::uint32_t>(1 + i / 100);
  fix.protection_radius_m = 0.1 * (5 + i % 20);
  fix.status = i % 7 == 3 ? core::FixStatus::Ambiguous : core::FixStatus::Fix;
  if (i % 5 == 4) {
    fix.status = core::FixStatus::NoFix;
    fix.reason = core::FixReason::NoOverlap;
  }
  return report;
}

void say_expected(const core::Fix& fix) {
  const bool has_pose = fix.status != core::FixStatus::NoFix;
  const char* const status = !has_pose ? "no_fix" : fix.status == core::FixStatus::Fix ? "fix" : "ambiguous";
  std::printf("%.2f %s", static_cast<double>(fix.time.middle_utc.count()) * 1e-9, status);
  if (has_pose) {
    const double heading_deg = fix.pose_W.heading_rad * 180.0 / M_PI;
    std::printf(" %.3f %.3f %.2f", fix.pose_W.x_m, fix.pose_W.y_m,
                heading_deg < 0.0 ? heading_deg + 360.0 : heading_deg);
    std::printf(" %u %.2f", fix.map, fix.protection_radius_m);
  }
  std::printf("\n");
}

class Outputs {
 public:
  Outputs()
      : sink_(resolve_lcm_url("", std::getenv("LCM_DEFAULT_URL")).value()),
        publisher_(LcmPublisher::create({}, sink_).value()) {
    NmeaTcpConfig config;
    config.enabled = true;
    config.port = static_cast<std::uint32_t>(10'000 + ::getpid() % 50'000);
    server_ = NmeaTcpServer::create(config).value();
    sink_.service(hal::monotonic_now());
    server_->step(hal::monotonic_now());
  }

  [[nodiscard]] bool ready() const { return sink_.is_open() && server_->port() != 0; }
  [[nodiscard]] int port() const { return server_->port(); }
  [[nodiscard]] std::string problem() const {
    return std::string(sink_.problem()) + ' ' + std::string(server_->problem());
  }

  void send(const FixReport& report) {
    const hal::Stamp now = hal::monotonic_now();
    server_->step(now);
    publisher_.publish(report);
    std::array<char, kNmeaEpochBytesMax> text{};
    const std::size_t size = format_nmea(report.fix, NmeaContext{}, text);
    server_->send({text.data(), size}, {now, now + hal::realtime_ahead()});
    server_->step(now);
  }

  void send_all() {
    publisher_.publish(sample_status(), std::chrono::seconds(1'752'488'130));
    const auto landmarks = sample_landmarks(60);
    publisher_.publish(view_of(landmarks));
    const SampleMap map(100);
    LcmMapView view = map.view();
    view.initialization = sample_report().initialization;
    static_cast<void>(publisher_.publish(view, 0, 10));
  }

 private:
  LcmSink sink_;
  LcmPublisher publisher_;
  std::unique_ptr<NmeaTcpServer> server_;
};

int run() {
  Outputs outputs;
  if (!outputs.ready()) {
    std::fprintf(stderr, "%s\n", outputs.problem().c_str());
    return EXIT_FAILURE;
  }
  std::cout << outputs.port() << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    if (line == "warm") {
      outputs.send(report_of(4));
      continue;
    }
    const int count = std::stoi(line.substr(line.find(' ')));
    for (int i = 0; i < count; ++i) {
      const FixReport report = report_of(i);
      say_expected(report.fix);
      outputs.send(report);
      if (i % 10 == 0) {
        outputs.send_all();
      }
      std::this_thread::sleep_for(kBetweenPoses);
    }
    std::cout << "done" << std::endl;
  }
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace slamsensor::tests

int main() {
  return slamsensor::tests::run();
}
