// Runs the sensor's NMEA output in real time through a seeded story, for gpsd to read. Says on its standard
// output, a JSON object per line: where it can be read, what is true from here on, the stamp of each epoch,
// at the end its counters.
#include "firmware/config/sensor_config.hpp"
#include "firmware/output/nmea_publisher.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "firmware/serving/nmea_serial_sink.hpp"
#include "firmware/serving/nmea_tcp_server.hpp"
#include "firmware/status/sensor_status.hpp"
#include "hal/clock.hpp"
#include "tests/contract/pseudo_terminal.hpp"

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/LocalCartesian.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <termios.h>
#include <vector>

namespace slamsensor::tests {
namespace {

/// What becomes true of a sensor, chapter by chapter: a fix at a place that it was kidnapped to, an ambiguous
/// scan, one without a fix, a lost device, a fix that got stale. Each chapter is said on the standard output
/// as it begins.
class NmeaStory {
 public:
  NmeaStory(const std::optional<firmware::Datum>& datum, unsigned seed) : datum_(datum), random_(seed) {}

  firmware::SensorStatus& status() { return status_; }
  [[nodiscard]] hal::Stamp next() const { return next_; }

  /// Goes on to the next chapter and says what it is.
  void turn(const firmware::OutputTime& at) {
    next_ = at.monotonic + hal::from_seconds(uniform(0.3, 1.8));
    const int kind = std::uniform_int_distribution(0, 9)(random_);
    static constexpr std::array<core::FixReason, 3> kReasons = {
        core::FixReason::NoOverlap, core::FixReason::TooFewLandmarks, core::FixReason::Moved};
    core::Fix& fix = status_.report.fix;
    if (kind < 5) {
      scan(at);
      fix.status = core::FixStatus::Fix;
      fix.reason = core::FixReason::None;
      status_.state = firmware::SensorState::Fixed;
    } else if (kind == 5) {
      scan(at);
      fix.status = core::FixStatus::Ambiguous;
      fix.reason = core::FixReason::Symmetric;
      status_.state = firmware::SensorState::Ambiguous;
    } else if (kind < 8) {
      scan(at);
      fix.status = core::FixStatus::NoFix;
      fix.reason = kReasons[static_cast<std::size_t>(uniform(0.0, 2.99))];
      status_.state = firmware::SensorState::Lost;
    } else {
      fix.status = core::FixStatus::NoFix;
      fix.reason = kind == 8 ? core::FixReason::Device : core::FixReason::Stale;
      status_.state = kind == 8 ? firmware::SensorState::Faulted : firmware::SensorState::Lost;
    }
    tell(at);
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  /// A scan that has just ended somewhere; the place told is off by what its covariance says.
  void scan(const firmware::OutputTime& at) {
    core::Fix& fix = status_.report.fix;
    truth_ = {uniform(-300.0, 300.0), uniform(-300.0, 300.0), uniform(-3.14, 3.14)};
    const double sigma_x_m = uniform(0.02, 0.5);
    const double sigma_y_m = uniform(0.02, 0.5);
    const double correlation = uniform(-0.8, 0.8);
    fix.covariance << sigma_x_m * sigma_x_m, correlation * sigma_x_m * sigma_y_m, 0.0,
        correlation * sigma_x_m * sigma_y_m, sigma_y_m * sigma_y_m, 0.0, 0.0, 0.0, 1e-6;
    std::normal_distribution<double> normal;
    const double a = normal(random_);
    const double b = normal(random_);
    fix.pose_W = truth_;
    fix.pose_W.x_m += sigma_x_m * a;
    fix.pose_W.y_m += sigma_y_m * (correlation * a + std::sqrt(1.0 - correlation * correlation) * b);
    fix.time = {at.utc - std::chrono::seconds(4), at.utc - std::chrono::seconds(2), at.utc, at.monotonic};
    fix.matches = static_cast<std::uint32_t>(uniform(4.0, 20.0));
    fix.landmarks_seen = 25;
    ++fix.scan;
  }

  struct Place {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
  };
  /// By GeographicLib alone, the map turned by hand.
  [[nodiscard]] Place place(double x_m, double y_m) const {
    const double beta = datum_->bearing_deg * core::kDegree;
    const GeographicLib::LocalCartesian plane(datum_->latitude_deg, datum_->longitude_deg, datum_->height_m);
    Place place;
    double height_m = 0.0;
    plane.Reverse(x_m * std::sin(beta) - y_m * std::cos(beta), x_m * std::cos(beta) + y_m * std::sin(beta),
                  0.0, place.latitude_deg, place.longitude_deg, height_m);
    return place;
  }

  void tell(const firmware::OutputTime& at) const {
    const core::Fix& fix = status_.report.fix;
    std::printf("{\"utc\": %.6f, \"status\": %d", static_cast<double>(at.utc.count()) * 1e-9,
                static_cast<int>(fix.status));
    if (datum_ && fix.status == core::FixStatus::Fix) {
      const Place told = place(fix.pose_W.x_m, fix.pose_W.y_m);
      const Place ahead = place(fix.pose_W.x_m + 0.5 * std::cos(fix.pose_W.heading_rad),
                                fix.pose_W.y_m + 0.5 * std::sin(fix.pose_W.heading_rad));
      const Place truth = place(truth_.x_m, truth_.y_m);
      double north_azimuth_deg = 0.0;
      double unused = 0.0;
      double distance_m = 0.0;
      const GeographicLib::Geodesic& earth = GeographicLib::Geodesic::WGS84();
      earth.Inverse(told.latitude_deg, told.longitude_deg, ahead.latitude_deg, ahead.longitude_deg,
                    distance_m, north_azimuth_deg, unused);
      double error_azimuth_deg = 0.0;
      earth.Inverse(told.latitude_deg, told.longitude_deg, truth.latitude_deg, truth.longitude_deg,
                    distance_m, error_azimuth_deg, unused);
      std::printf(", \"lat\": %.11f, \"lon\": %.11f, \"heading\": %.6f, \"east_m\": %.6f, \"north_m\": %.6f",
                  told.latitude_deg, told.longitude_deg, std::fmod(north_azimuth_deg + 360.0, 360.0),
                  distance_m * std::sin(error_azimuth_deg * core::kDegree),
                  distance_m * std::cos(error_azimuth_deg * core::kDegree));
    }
    std::printf("}\n");
    std::fflush(stdout);
  }

  std::optional<firmware::Datum> datum_;
  std::mt19937_64 random_;
  firmware::SensorStatus status_;
  core::Pose2 truth_;
  hal::Stamp next_{};
};

using namespace firmware;
using namespace std::chrono_literals;

enum class Transport { Pty, Tcp };

struct Options {
  Transport transport = Transport::Pty;
  double rate_hz = 1.0;
  double seconds = 10.0;
  unsigned seed = 1;
  std::optional<Datum> datum;
  std::string save;
};

OutputTime now() {
  const hal::Stamp monotonic = hal::monotonic_now();
  return {monotonic, monotonic + hal::realtime_ahead()};
}

/// Writes every epoch into a file, as a recording does, and says its time stamp.
class Tap final : public EpochSink {
 public:
  explicit Tap(const std::string& path) : file_(path, std::ios::binary) {}
  void step(hal::Stamp) noexcept override {}
  void send(std::span<const char> epoch, const OutputTime&) noexcept override {
    file_.write(epoch.data(), static_cast<std::streamsize>(epoch.size()));
    std::printf("{\"stamp\": \"%.9s\"}\n", epoch.data() + std::string_view("$GPRMC,").size());
    std::fflush(stdout);
  }
  std::size_t poll_on(std::span<pollfd>) const noexcept override { return 0; }
  std::string_view problem() const noexcept override { return {}; }
  std::span<const hal::Counter> counters() const noexcept override { return {}; }

 private:
  std::ofstream file_;
};

/// Two pseudo-terminals whose far ends are wired together, as a cable does: the sensor at one, gpsd at the
/// other.
class Cable {
 public:
  Cable() {
    const int fd = ::open(reader_.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios raw{};
    ::tcgetattr(fd, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(fd, TCSANOW, &raw);
    ::close(fd);  // gpsd leaves a port alone that somebody else holds
  }
  [[nodiscard]] std::string sensor_path() const { return sensor_.path(); }
  [[nodiscard]] std::string reader_path() const {
    return std::filesystem::canonical(reader_.path()).string();
  }
  [[nodiscard]] std::array<pollfd, 2> poll_on() const {
    return {{{sensor_.master(), POLLIN, 0}, {reader_.master(), POLLIN, 0}}};
  }
  void carry() {
    carry(sensor_, reader_);
    carry(reader_, sensor_);
  }

 private:
  static void carry(PseudoTerminal& from, PseudoTerminal& to) {
    const std::vector<std::uint8_t> bytes = from.read();
    static_cast<void>(!::write(to.master(), bytes.data(), bytes.size()));
  }
  PseudoTerminal sensor_;
  PseudoTerminal reader_;
};

/// The sinks that the options ask for, and what leads from them to the reader.
struct Outlets {
  explicit Outlets(const Options& options) {
    if (options.transport == Transport::Pty) {
      cable.emplace();
      sink = NmeaSerialSink::open({cable->sensor_path(), 115'200}, hal::from_seconds(1.0 / options.rate_hz))
                 .value();
      sink->step(hal::monotonic_now());
      std::printf("{\"device\": \"%s\"}\n", cable->reader_path().c_str());
    } else {
      auto server = NmeaTcpServer::create({.enabled = true, .address = "127.0.0.1", .port = 0}).value();
      server->step(hal::monotonic_now());
      std::printf("{\"device\": \"tcp://127.0.0.1:%u\"}\n", server->port());
      sink = std::move(server);
    }
    std::fflush(stdout);
  }

  /// Waits for something to do, at most for `longest`.
  void wait(const NmeaPublisher& publisher, hal::Stamp longest) {
    std::array<pollfd, 16> entries{};
    std::size_t count = publisher.poll_on(entries);
    if (cable) {
      for (const pollfd& end : cable->poll_on()) {
        entries[count++] = end;
      }
    }
    // A terminal that nobody has open yet reports that without end.
    const timespec time{0, std::clamp<long>(static_cast<long>(longest.count()), 1'000'000, 100'000'000)};
    ::ppoll(entries.data(), count, &time, nullptr);
    if (cable) {
      cable->carry();
    }
  }

  std::optional<Cable> cable;
  std::unique_ptr<EpochSink> sink;
};

void run(const Options& options) {
  NmeaConfig config;
  config.zda = true;
  NmeaPublisher publisher({config, options.rate_hz, options.datum});
  Outlets outlets(options);
  Tap tap(options.save);
  static_cast<void>(publisher.add(*outlets.sink));
  static_cast<void>(publisher.add(tap));
  NmeaStory story(options.datum, options.seed);
  const hal::Stamp end = hal::monotonic_now() + hal::from_seconds(options.seconds);
  for (OutputTime time = now(); time.monotonic < end; time = now()) {
    if (time.monotonic >= story.next()) {
      story.turn(time);
    }
    story.status().report.monotonic = time.monotonic;
    publisher.step(time, story.status());
    outlets.wait(publisher, publisher.wait(now()));
  }
  CounterTable table;
  publisher.append_counters(table);
  std::printf("{\"counters\": {");
  const char* comma = "";
  for (const hal::Counter& counter : table.all()) {
    std::printf("%s\"%.*s\": %llu", comma, static_cast<int>(counter.name.size()), counter.name.data(),
                static_cast<unsigned long long>(counter.value));
    comma = ", ";
  }
  std::printf("}}\n");
  std::fflush(stdout);
  std::string line;  // the reader keeps its line until it says so
  std::getline(std::cin, line);
}

}  // namespace
}  // namespace slamsensor::tests

int main(int argc, char** argv) {
  using namespace slamsensor;
  if (argc != 6 && argc != 10) {
    std::fprintf(stderr,
                 "usage: nmea_rig pty|tcp RATE_HZ SECONDS SEED FILE [LATITUDE LONGITUDE HEIGHT BEARING]\n");
    return 64;
  }
  tests::Options options;
  options.transport = std::string(argv[1]) == "tcp" ? tests::Transport::Tcp : tests::Transport::Pty;
  options.rate_hz = std::atof(argv[2]);
  options.seconds = std::atof(argv[3]);
  options.seed = static_cast<unsigned>(std::atoi(argv[4]));
  options.save = argv[5];
  if (argc == 10) {
    options.datum =
        firmware::Datum{std::atof(argv[6]), std::atof(argv[7]), std::atof(argv[8]), std::atof(argv[9])};
  }
  tests::run(options);
}
