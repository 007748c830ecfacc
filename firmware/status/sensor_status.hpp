#pragma once

#include "core/fix.hpp"
#include "core/memory/fixed_vector.hpp"
#include "core/reading.hpp"
#include "hal/counters.hpp"
#include "hal/device.hpp"
#include "hal/fixed_text.hpp"
#include "hal/stamp.hpp"
#include "hal/transport/reopen.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::firmware {

/// Of the product; that of the CMake project.
inline constexpr std::string_view kVersion = SLAMSENSOR_VERSION;

/// The one word for how the sensor stands. Each has one entry reason; NMEA is valid in Fixed alone.
enum class SensorState : std::uint8_t {
  Starting,   ///< the devices have not all answered since start
  Scanning,   ///< they work; no scan has been localised yet
  Fixed,      ///< the last scan gave a fix, and it is not stale
  Ambiguous,  ///< the last scan fits more than one place
  Lost,       ///< the last scan gave no fix, or is stale
  Held,       ///< scanning is not allowed: interlock open, or paused on command
  Faulted,    ///< a device that has worked does not, or the devices answer and no scan comes of it
};
inline constexpr std::array<std::string_view, 7> kSensorStateNames = {
    "starting", "scanning", "fixed", "ambiguous", "lost", "held", "faulted"};

/// Counters of one station, copied at one moment.
inline constexpr std::size_t kStatusCountersMax = 48;
struct CounterTable {
  std::array<hal::Counter, kStatusCountersMax> counters{};
  std::size_t size = 0;

  [[nodiscard]] std::span<const hal::Counter> all() const noexcept { return {counters.data(), size}; }
  /// Appends; what does not fit is left out.
  void append(std::span<const std::string_view> names, std::span<const std::uint64_t> values) noexcept {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const hal::Counter counter{names[i], values[i]};
      append(std::span(&counter, 1));
    }
  }
  void append(std::span<const hal::Counter> more) noexcept {
    for (const hal::Counter& counter : more) {
      if (size < counters.size()) {
        counters[size++] = counter;
      }
    }
  }
};

using ProblemText = hal::FixedText<hal::kProblemMax>;

struct DeviceStatus {
  hal::DeviceState state = hal::DeviceState::Absent;
  ProblemText problem;           ///< of the driver, its link or its timing, or its remark; empty for none
  ProblemText last_loss;         ///< why it was Ready no more, the last time; empty before the first
  hal::FixedText<80> model;      ///< as the device said; empty before it did
  std::uint32_t recoveries = 0;  ///< times it got Ready again after it had been
  hal::Stamp last_recovery{};    ///< how long the last of them took, from the loss
  CounterTable counters;
};

/// How the scan thread stands. Made by it, handed over as a value.
struct HeadStatus {
  hal::Stamp stamp{};
  DeviceStatus pan_tilt;
  DeviceStatus rangefinder;
  std::optional<DeviceStatus> inclinometer;  ///< when one is configured
  std::optional<core::Attitude> attitude;    ///< by which the readings are levelled
  std::string_view phase = "waiting";        ///< waiting, calibrating, scanning
  ProblemText problem;                       ///< what keeps it from scanning; empty when nothing does
  bool timing_in_doubt = false;              ///< of a device: its problem says why
  bool failing = false;                      ///< the devices answer, but no scan comes of it: `problem`
  bool held = false;                         ///< interlock open or paused on command
  std::uint32_t scan = 0;                    ///< number of the scan under way or next
  std::uint32_t line = 0;                    ///< of it
  std::uint32_t lines = 0;                   ///< in all
  double pan_rad = 0.0;
  double tilt_rad = 0.0;
  double latency_s = 0.0;
  double latency_sigma_s = 0.0;
  double readings_hz = 0.0;  ///< over the last second
  std::uint64_t readings = 0;
  CounterTable counters;          ///< of scheduler, assembler, thread (drops, slips, misses)
  std::uint32_t stops = 0;        ///< times the thread did not run for a second or more since start
  hal::Stamp last_stop{};         ///< how long the last of them was
  hal::Stamp wake_latency_max{};  ///< worst lateness of the thread's wake-up since start
};

/// How the SLAM thread stands.
struct SlamStatus {
  std::uint32_t scans = 0;  ///< processed since start
  std::uint32_t fixes = 0;
  std::uint32_t landmarks = 0;  ///< in the home map
  std::uint32_t hypotheses = 0;
  std::uint32_t local_maps = 0;       ///< not tied to the home map yet
  std::uint32_t local_landmarks = 0;  ///< in those
  std::uint64_t map_revision = 0;     ///< grows whenever the best map changes
  bool frozen = false;
  hal::Stamp process_last{};  ///< time from the end of the scan to its fix
  hal::Stamp process_max{};
  CounterTable counters;
};

/// Another place in the map of an ambiguous answer that explains the same scan.
struct RivalPlace {
  core::Pose2 pose_W;
  std::uint32_t matches = 0;
};
inline constexpr std::size_t kRivalsMax = 8;
using RivalPlaces = core::FixedVector<RivalPlace, kRivalsMax>;

/// Where the readings come from.
enum class SourceMode : std::uint8_t { Live, Emulated };

/// The fix with what the daemon adds to it: everything that outputs write comes from here.
struct FixReport {
  core::Fix fix;
  SourceMode source = SourceMode::Live;
  hal::Stamp monotonic{};                       ///< when this report was made
  hal::Stamp uptime{};                          ///< of the daemon
  std::optional<hal::Stamp> time_to_first_fix;  ///< from the daemon's start
  std::uint64_t initialization = 0;             ///< differs from start to start
};

/// Everything about the sensor at one moment: of status, ctl, top, LCM.
struct SensorStatus {
  SensorState state = SensorState::Starting;
  FixReport report;
  HeadStatus head;
  SlamStatus slam;
  CounterTable outputs;  ///< of NMEA, LCM, store, control
  hal::FixedText<64> map_name;
  hal::Stamp map_saved_ago{};  ///< since the last save; hal::kNever before the first
  bool map_unsaved = false;
  bool realtime = false;  ///< SCHED_FIFO and locked memory are in force
  bool recording = false;
};

}  // namespace slamsensor::firmware
