#pragma once

#include "tools/emulator/emulated_head.hpp"
#include "tools/output/write_file.hpp"

#include <filesystem>
#include <string>

namespace slamsensor::tools {

/// Where the sensor was put, as a trajectory in the format of the TUM RGB-D benchmark: a line per stand and
/// kidnap, t the time in s at which it got there, counted from `origin` (the clock's time at the head's 0).
[[nodiscard]] std::string format_visits(const EmulatedHead& head, Stamp origin);

/// `t_s,event,device,fault,duration_s,known`: a line per stand, kidnap and fault, in the order of time. An
/// event is "stand", "kidnap" or "fault"; known is 0 for a fault that the device does not have.
[[nodiscard]] std::string format_events(const EmulatedHead& head, Stamp origin);

/// "run.tum" has its events in "run.events.csv".
[[nodiscard]] std::filesystem::path events_path(const std::filesystem::path& truth);

/// Both are written, the second beside the first.
[[nodiscard]] tl::expected<void, OutputError> write_truth(const EmulatedHead& head, Stamp origin,
                                                          const std::filesystem::path& truth);

}  // namespace slamsensor::tools
