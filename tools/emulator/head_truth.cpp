#include "tools/emulator/head_truth.hpp"

#include "tools/output/number_text.hpp"
#include "tools/output/trajectory_tum.hpp"

#include <algorithm>
#include <vector>

namespace slamsensor::tools {
namespace {

struct Line {
  Stamp at{};
  std::string text;
};

/// The number nearest to `time`, so that its shortest text is short.
double seconds_of(Stamp time) noexcept {
  return static_cast<double>(time.count()) / 1e9;
}

Line line_of(const VisitRecord& record) {
  return {record.at, record.visit.kind == VisitKind::Stand ? "stand,,,,1" : "kidnap,,,,1"};
}

Line line_of(const FaultRecord& record) {
  const Fault& fault = record.due.fault;
  Line line{fault.at, "fault," + record.due.device + ','};
  line.text.append(name_of(fault.kind)).push_back(',');
  append_shortest(line.text, seconds_of(fault.duration));
  line.text += record.known ? ",1" : ",0";
  return line;
}

}  // namespace

std::string format_visits(const EmulatedHead& head, Stamp origin) {
  std::vector<TimedPose> poses;
  for (const VisitRecord& record : head.visits()) {
    poses.push_back({seconds_of(origin + record.at), record.visit.pose_W});
  }
  return format_trajectory(poses);
}

std::string format_events(const EmulatedHead& head, Stamp origin) {
  std::vector<Line> lines;
  for (const VisitRecord& record : head.visits()) {
    lines.push_back(line_of(record));
  }
  for (const FaultRecord& record : head.faults()) {
    lines.push_back(line_of(record));
  }
  std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.at < b.at; });
  std::string text = "t_s,event,device,fault,duration_s,known\n";
  for (const Line& line : lines) {
    append_fixed(text, seconds_of(origin + line.at), 6);
    text += ',' + line.text + '\n';
  }
  return text;
}

std::filesystem::path events_path(const std::filesystem::path& truth) {
  return std::filesystem::path(truth).replace_extension(".events.csv");
}

tl::expected<void, OutputError> write_truth(const EmulatedHead& head, Stamp origin,
                                            const std::filesystem::path& truth) {
  return write_file(truth, format_visits(head, origin)).and_then([&] {
    return write_file(events_path(truth), format_events(head, origin));
  });
}

}  // namespace slamsensor::tools
