#include "tools/world/simulate.hpp"

#include "tools/output/text_output.hpp"
#include "tools/world/random.hpp"
#include "tools/world/world_config.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <system_error>

namespace slamsensor::tools {
namespace {

constexpr double kCountMax = 100'000.0;
constexpr double kReadingsMax = 50e6;

double pan_steps(const SweepConfig& sweep) noexcept {
  return std::round((sweep.pan_max_rad - sweep.pan_min_rad) / sweep.pan_step_rad);
}

double tilt_steps(const SweepConfig& sweep) noexcept {
  return std::round((sweep.tilt_max_rad - sweep.tilt_min_rad) / sweep.tilt_step_rad);
}

double line_duration_s(const SweepConfig& sweep) noexcept {
  return static_cast<double>(readings_per_line(sweep)) / sweep.readings_per_second + sweep.line_change_s;
}

bool within(double value, double min, double max) noexcept {
  return value >= min && value <= max;  // false for not-a-number
}

}  // namespace

SweepConfig paper_sweep_1_2() noexcept {
  return {};
}

SweepConfig paper_sweep_3_4() noexcept {
  SweepConfig sweep;
  sweep.tilt_min_rad = -340.0 * firmware::kPaperStep_rad;
  sweep.tilt_max_rad = 160.0 * firmware::kPaperStep_rad;
  sweep.tilt_step_rad = 20.0 * firmware::kPaperStep_rad;
  return sweep;
}

std::optional<WorldError> find_problem(const SweepConfig& sweep) {
  constexpr double kTurn = 2.0 * std::numbers::pi + 1e-9;
  constexpr double kUpright = 0.5 * std::numbers::pi + 1e-9;
  if (!(sweep.pan_step_rad > 0.0 && sweep.tilt_step_rad > 0.0 && sweep.readings_per_second > 0.0)) {
    return WorldError{"sweep: pan step, tilt step and readings per second must be above zero"};
  }
  if (!within(sweep.pan_max_rad - sweep.pan_min_rad, 0.0, kTurn) ||
      !within(sweep.tilt_min_rad, -kUpright, kUpright) ||
      !within(sweep.tilt_max_rad, sweep.tilt_min_rad, kUpright)) {
    return WorldError{
        "sweep: pan must span 0 to 360 deg, and tilt must rise from its least to its greatest in +-90 deg"};
  }
  if (!within(sweep.mount_height_m, 0.0, 100.0) || !within(sweep.line_change_s, 0.0, 3600.0) ||
      !within(sweep.roll_rad, -kUpright, kUpright) || !within(sweep.pitch_rad, -kUpright, kUpright)) {
    return WorldError{
        "sweep: mount height must be 0 to 100 m, line change 0 to 3600 s, roll and pitch within +-90 deg"};
  }
  const double readings = pan_steps(sweep);
  const double lines = tilt_steps(sweep) + 1.0;
  if (!within(readings, 1.0, kCountMax) || !within(lines, 1.0, kCountMax) ||
      readings * lines > kReadingsMax) {
    return WorldError{
        "sweep: 1 to 100000 scanlines of 1 to 100000 readings, 50 million in all; change the steps"};
  }
  return std::nullopt;
}

std::size_t line_count(const SweepConfig& sweep) noexcept {
  return static_cast<std::size_t>(tilt_steps(sweep)) + 1;
}

std::size_t readings_per_line(const SweepConfig& sweep) noexcept {
  return static_cast<std::size_t>(pan_steps(sweep));
}

double reading_time_s(const SweepConfig& sweep, std::size_t line, std::size_t index) noexcept {
  return static_cast<double>(line) * line_duration_s(sweep) +
         static_cast<double>(index) / sweep.readings_per_second;
}

double scan_duration_s(const SweepConfig& sweep) noexcept {
  return reading_time_s(sweep, line_count(sweep) - 1, readings_per_line(sweep) - 1);
}

double reading_pan_rad(const SweepConfig& sweep, std::size_t line, std::size_t index) noexcept {
  const bool leftwards = sweep.order == SweepOrder::BackAndForth && line % 2 == 1;
  const std::size_t step = leftwards ? index : readings_per_line(sweep) - 1 - index;
  return sweep.pan_min_rad + (static_cast<double>(step) + 0.5) * sweep.pan_step_rad;
}

SensorPlace sensor_place(const World& world, const SweepConfig& sweep, const core::Pose2& pose_W) noexcept {
  const Eigen::Vector3d position_W(pose_W.x_m, pose_W.y_m,
                                   world.ground_height_m(pose_W.x_m, pose_W.y_m) + sweep.mount_height_m);
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(pose_W.heading_rad, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond pitch(Eigen::AngleAxisd(sweep.pitch_rad, Eigen::Vector3d::UnitY()));
  const Eigen::Quaterniond roll(Eigen::AngleAxisd(sweep.roll_rad, Eigen::Vector3d::UnitX()));
  return {position_W, (heading * pitch * roll).toRotationMatrix()};
}

Eigen::Vector3d direction_L(double pan_rad, double cos_tilt, double sin_tilt) noexcept {
  return {cos_tilt * std::cos(pan_rad), cos_tilt * std::sin(pan_rad), sin_tilt};
}

std::vector<std::vector<core::Reading>> scan(const World& world, const SweepConfig& sweep,
                                             const core::Pose2& pose_W, double start_s, std::uint64_t seed) {
  if (find_problem(sweep)) {
    return {};
  }
  Random rng(seed);
  const SensorPlace place = sensor_place(world, sweep, pose_W);
  const std::size_t readings = readings_per_line(sweep);
  std::vector<std::vector<core::Reading>> lines(line_count(sweep));
  for (std::size_t line = 0; line < lines.size(); ++line) {
    const double tilt_rad = sweep.tilt_min_rad + static_cast<double>(line) * sweep.tilt_step_rad;
    const double cos_tilt = std::cos(tilt_rad);
    const double sin_tilt = std::sin(tilt_rad);
    lines[line].reserve(readings);
    for (std::size_t i = 0; i < readings; ++i) {
      const double pan_rad = reading_pan_rad(sweep, line, i);
      const Eigen::Vector3d direction_W = place.R_W_L * direction_L(pan_rad, cos_tilt, sin_tilt);
      const double time_s = start_s + reading_time_s(sweep, line, i);
      const Range range = world.cast(place.position_W, direction_W, time_s, rng);
      lines[line].push_back({pan_rad, tilt_rad, range.range_m});
    }
  }
  return lines;
}

namespace {

// Random streams of the simulation's seed.
constexpr std::uint64_t kDriveStream = 0;
constexpr std::uint64_t kFirstScanStream = 1;

tl::expected<World, WorldError> make_world(const SimulateOptions& options) {
  auto config = load_world(options.world);
  if (!config) {
    return tl::unexpected(std::move(config.error()));
  }
  config->seed = options.world_seed.value_or(config->seed);
  return World::create(*config);
}

// Scans of an earlier run with higher numbers would be read as part of this one.
tl::expected<void, WorldError> prepare_folder(const std::filesystem::path& out, std::size_t scans) {
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error) {
    return tl::unexpected(
        WorldError{out.string() + ": cannot be made (" + error.message() + "); choose another folder"});
  }
  const std::filesystem::path next = out / scan_file_name(scans + 1);
  if (std::filesystem::exists(next, error)) {
    return tl::unexpected(WorldError{out.string() + " holds more scans than this run makes (" +
                                     next.filename().string() + "); empty it or choose another folder"});
  }
  return {};
}

void count(const std::vector<std::vector<core::Reading>>& lines, SimulateSummary& summary) {
  ++summary.scans;
  for (const std::vector<core::Reading>& line : lines) {
    summary.readings += line.size();
    summary.returns += static_cast<std::uint64_t>(
        std::count_if(line.begin(), line.end(), [](const core::Reading& r) { return r.has_return(); }));
  }
}

tl::expected<void, WorldError> write(const std::filesystem::path& path, std::string_view content) {
  return write_file(path, content).map_error([](const OutputError& error) {
    return WorldError{error.message};
  });
}

tl::expected<SimulateSummary, WorldError> write_scans(const SimulateOptions& options, const World& world,
                                                      const std::vector<Stand>& stands) {
  SimulateSummary summary;
  summary.objects = static_cast<std::uint32_t>(world.objects().size());
  summary.unplaced = world.unplaced();
  for (std::size_t i = 0; i < stands.size(); ++i) {
    const auto lines = scan(world, options.sweep, stands[i].pose, stands[i].time_s,
                            mix_seed(options.seed, kFirstScanStream + i));
    if (auto written = write(options.out / scan_file_name(i + 1), format_scan(lines)); !written) {
      return tl::unexpected(std::move(written.error()));
    }
    count(lines, summary);
    if (options.on_progress) {
      options.on_progress({summary.scans, static_cast<std::uint32_t>(stands.size())});
    }
  }
  return summary;
}

}  // namespace

std::vector<std::filesystem::path> simulated_files(const SimulateOptions& options) {
  std::vector<std::filesystem::path> files{options.out / "stems.csv", options.out / "truth.tum"};
  for (std::size_t scan = 1; scan <= options.drive.stands; ++scan) {
    files.push_back(options.out / scan_file_name(scan));
  }
  return files;
}

tl::expected<SimulateSummary, WorldError> simulate(const SimulateOptions& options) {
  if (auto problem = find_problem(options.sweep)) {
    return tl::unexpected(std::move(*problem));
  }
  const auto world = make_world(options);
  if (!world) {
    return tl::unexpected(world.error());
  }
  const auto stands = make_drive(*world, options.drive, mix_seed(options.seed, kDriveStream));
  if (!stands) {
    return tl::unexpected(stands.error());
  }
  const std::string truth = format_truth(*world, options.sweep, *stands);
  return prepare_folder(options.out, stands->size())
      .and_then([&] { return write(options.out / "stems.csv", format_stems(world->objects())); })
      .and_then([&] { return write(options.out / "truth.tum", truth); })
      .and_then([&] { return write_scans(options, *world, *stands); });
}

namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr std::size_t kBytesPerReading = 28;

void append(std::string& text, double value, int decimals, char after) {
  char buffer[400];  // the longest double in fixed notation has 309 digits before the point
  char* const end =
      std::to_chars(buffer, buffer + sizeof(buffer), value, std::chars_format::fixed, decimals).ptr;
  text.append(buffer, end);
  text.push_back(after);
}

}  // namespace

std::string scan_file_name(std::size_t number) {
  constexpr std::size_t kDigits = 4;
  std::string digits = std::to_string(number);
  digits.insert(0, digits.size() < kDigits ? kDigits - digits.size() : 0, '0');
  return "scan_" + digits + ".csv";
}

std::string format_scan(const std::vector<std::vector<core::Reading>>& lines) {
  std::string text = "pan_deg,tilt_deg,range_m\n";
  text.reserve(lines.empty() ? text.size() : lines.size() * lines.front().size() * kBytesPerReading);
  for (const std::vector<core::Reading>& line : lines) {
    for (const core::Reading& reading : line) {
      append(text, reading.pan_rad * kDegreesPerRadian, 5, ',');
      append(text, reading.tilt_rad * kDegreesPerRadian, 5, ',');
      if (reading.has_return()) {
        append(text, reading.range_m, 3, '\n');
      } else {
        text.push_back('\n');
      }
    }
  }
  return text;
}

std::string format_truth(const World& world, const SweepConfig& sweep, std::span<const Stand> stands) {
  std::string text;
  for (std::size_t i = 0; i < stands.size(); ++i) {
    const SensorPlace place = sensor_place(world, sweep, stands[i].pose);
    const Eigen::Quaterniond q(place.R_W_L);
    append(text, static_cast<double>(i + 1), 0, ' ');
    for (const double coordinate : {place.position_W.x(), place.position_W.y(), place.position_W.z()}) {
      append(text, coordinate, 6, ' ');
    }
    append(text, q.x(), 9, ' ');
    append(text, q.y(), 9, ' ');
    append(text, q.z(), 9, ' ');
    append(text, q.w(), 9, '\n');
  }
  return text;
}

std::string format_stems(std::span<const Object> objects) {
  std::string text = "id,x_m,y_m,radius_m,height_m,kind\n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Object& object = objects[i];
    text += std::to_string(i + 1) + ',';
    append(text, object.x_m, 4, ',');
    append(text, object.y_m, 4, ',');
    append(text, object.radius_m, 4, ',');
    append(text, object.height_m, 3, ',');
    text.append(name_of(object.kind)).push_back('\n');
  }
  return text;
}

}  // namespace slamsensor::tools
