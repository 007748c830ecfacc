#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"
#include "firmware/config/rows/text_rules.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;

// Names of the enumerators, in their order.
constexpr std::string_view kModes[] = {"required", "optional", "off"};

constexpr auto kDaemon = &Config::daemon;
constexpr auto kRealtime = &DaemonConfig::realtime;

constexpr Section kSections[] = {
    {"realtime", "What the threads that read the devices and find the pose ask of the machine."},
    {"map", "Where maps are kept."},
    {"control", "How the running sensor is controlled."},
    {"record", "Recordings of all that comes in and goes out."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"realtime.mode", "", "required: no start without it; optional: as much as is granted, and the log says so.",
     choice<kDaemon, kRealtime, &RealtimeConfig::mode>(kModes)},
    {"realtime.scan_priority", "", "SCHED_FIFO priority of the thread that reads the devices.",
     integer<kDaemon, kRealtime, &RealtimeConfig::scan_priority>(1, 99)},
    {"realtime.slam_priority", "", "The same of the thread that finds the pose; below scan_priority.",
     integer<kDaemon, kRealtime, &RealtimeConfig::slam_priority>(1, 99)},
    {"realtime.scan_period_s", "s", "Between two looks at the devices.",
     real<kDaemon, kRealtime, &RealtimeConfig::scan_period_s>(0.0005, 0.01)},
    {"realtime.scan_deadline_s", "s", "A look that ends later than this after it was due is a counted miss.",
     real<kDaemon, kRealtime, &RealtimeConfig::scan_deadline_s>(0.0005, 0.1)},
    {"realtime.slam_deadline_s", "s", "For the pose of a scan; then the search is cut.",
     real<kDaemon, kRealtime, &RealtimeConfig::slam_deadline_s>(0.01, 600.0)},
    {"realtime.scanlines_queued", "", "Scanlines that may wait for the pose of the one before.",
     integer<kDaemon, kRealtime, &RealtimeConfig::scanlines_queued>(2, 64)},

    {"map.directory", "", "Folder of the maps.",
     free_text<kDaemon, &DaemonConfig::map_store, &MapStoreConfig::directory>(kFolder)},
    {"map.name", "", "Map that is loaded at start and saved to.",
     free_text<kDaemon, &DaemonConfig::map_store, &MapStoreConfig::name>(kMapName)},
    {"map.autosave_s", "s", "Between two saves of a changed map; 0: never by itself.",
     real<kDaemon, &DaemonConfig::map_store, &MapStoreConfig::autosave_s>(0.0, 86'400.0), Apply::Live},
    {"map.frozen", "", "Localise only: the map never changes, in memory or on disk.",
     boolean<kDaemon, &DaemonConfig::map_store, &MapStoreConfig::frozen>(), Apply::Live},

    {"control.socket", "", "Path of the control socket of 'slamsensor ctl'.",
     free_text<kDaemon, &DaemonConfig::control, &ControlConfig::socket>(kSocketPath)},

    {"record.directory", "", "Folder of the recordings.",
     free_text<kDaemon, &DaemonConfig::record, &RecordConfig::directory>(kFolder)},
    {"record.size_max_mb", "MB", "A recording that reaches it is ended.",
     integer<kDaemon, &DaemonConfig::record, &RecordConfig::size_max_mb>(1, 1'000'000), Apply::Live},
};
// clang-format on

}  // namespace

SettingRows daemon_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
