#include "tools/world/simulate.hpp"

#include "tools/output/write_file.hpp"
#include "tools/world/random.hpp"
#include "tools/world/simulate_files.hpp"
#include "tools/world/world_loader.hpp"

#include <algorithm>
#include <string>
#include <system_error>

namespace slamsensor::tools {
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

}  // namespace slamsensor::tools
