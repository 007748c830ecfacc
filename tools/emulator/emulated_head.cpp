#include "tools/emulator/emulated_head.hpp"

#include "tools/output/result_files.hpp"
#include "tools/output/text_output.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kPendingMax = 65'536;  // shots of a device that reports none of them
constexpr std::uint64_t kNoiseStream = 0;
constexpr std::uint64_t kDropOutStream = 1;

}  // namespace

double reflectance_of(Surface surface) noexcept {
  switch (surface) {
    case Surface::None:
      return 0.0;
    case Surface::Crown:
    case Surface::Bush:
      return 0.5;  // leaves are bright beyond the red
    case Surface::Wall:
    case Surface::Car:
      return 0.6;
    case Surface::Person:
      return 0.4;
    case Surface::Ground:
    case Surface::Post:
      return 0.2;
    case Surface::Stem:
    case Surface::Rock:
      break;
  }
  return 0.3;
}

HeadScene::HeadScene(const World& world, const HeadSceneConfig& config)
    : world_(world),
      config_(config),
      place_(sensor_place(world, config.mount, {})),
      noise_(mix_seed(config.seed, kNoiseStream)),
      drop_outs_(mix_seed(config.seed, kDropOutStream)) {
}

void HeadScene::stand_at(const core::Pose2& pose_W) {
  place_ = sensor_place(world_, config_.mount, pose_W);
}

Target HeadScene::shoot(Stamp at) {
  const HeadAngles angles = pointing_ != nullptr ? pointing_->angles_at(at) : HeadAngles{};
  const Eigen::Vector3d direction_W =
      place_.R_W_L * direction_L(angles.pan_rad, std::cos(angles.tilt_rad), std::sin(angles.tilt_rad));
  const double time_s = hal::to_seconds(at);
  const Range range = world_.cast(place_.position_W, direction_W, time_s, noise_);
  Target target;
  if (config_.drop_out_share > 0.0 && draw_unit(drop_outs_) < config_.drop_out_share) {
    target.kind = TargetKind::LostShot;
  } else if (range.has_return()) {
    target = {TargetKind::Target, range.range_m, reflectance_of(range.surface)};
  }
  if (config_.truth_max > 0) {
    pending_.push_back({at, {}, angles, target});
    if (pending_.size() > kPendingMax) {
      pending_.pop_front();
    }
  }
  return target;
}

void HeadScene::reported(Stamp measured, Stamp on_wire) {
  while (!pending_.empty() && pending_.front().measured < measured) {
    pending_.pop_front();  // never reported
  }
  if (pending_.empty() || pending_.front().measured != measured) {
    return;
  }
  truth_.push_back(pending_.front());
  truth_.back().on_wire = on_wire;
  pending_.pop_front();
  if (truth_.size() > config_.truth_max) {
    truth_.pop_front();
  }
}

std::vector<ShotTruth> HeadScene::take_truth() {
  std::vector<ShotTruth> taken(truth_.begin(), truth_.end());
  truth_.clear();
  return taken;
}

namespace {

// Random streams of the scenario's seed.
constexpr std::uint64_t kSceneStream = 0;
constexpr std::uint64_t kFaultStream = 1;
constexpr std::uint64_t kDriveStream = 2;

}  // namespace

tl::expected<EmulatedHead::Parts, WorldError> EmulatedHead::parts_of(const Scenario& scenario) {
  if (auto problem = find_problem(scenario)) {
    return tl::unexpected(std::move(*problem));
  }
  WorldConfig config = scenario.world;
  HeadSceneConfig scene{scenario.mount, config.rangefinder.drop_out_share,
                        mix_seed(scenario.seed, kSceneStream), scenario.truth_max};
  config.rangefinder.drop_out_share = 0.0;  // the scene distinguishes lost shots from empty ones
  auto world = World::create(config);
  if (!world) {
    return tl::unexpected(std::move(world.error()));
  }
  auto stands = make_drive(*world, scenario.drive, mix_seed(scenario.seed, kDriveStream));
  if (!stands) {
    return tl::unexpected(std::move(stands.error()));
  }
  for (const Kidnap& kidnap : scenario.kidnaps) {
    if (!world->is_free(kidnap.pose_W.translation(), 0.0)) {
      return tl::unexpected(WorldError{"the kidnap at " + fixed_text(kidnap.at_s, 1) +
                                       " s ends inside an obstacle; move its x_m, y_m"});
    }
  }
  StandPlan plan(std::move(*stands), scenario.kidnaps, scenario.change);
  FaultPlan faults(scenario.faults, scenario.rates, mix_seed(scenario.seed, kFaultStream));
  return Parts{std::move(*world), scene, std::move(plan), std::move(faults)};
}

tl::expected<std::unique_ptr<EmulatedHead>, WorldError> EmulatedHead::create(const Scenario& scenario) {
  return create(scenario, make_head_devices);
}

tl::expected<std::unique_ptr<EmulatedHead>, WorldError> EmulatedHead::create(const Scenario& scenario,
                                                                             const DeviceMaker& make) {
  auto parts = parts_of(scenario);
  if (!parts) {
    return tl::unexpected(std::move(parts.error()));
  }
  auto head = std::unique_ptr<EmulatedHead>(new EmulatedHead(std::move(*parts)));
  auto devices = make(scenario, head->scene_);
  if (!devices) {
    return tl::unexpected(std::move(devices.error()));
  }
  head->plug_in(std::move(*devices));
  head->advance(Stamp{});
  return head;
}

EmulatedHead::EmulatedHead(Parts parts)
    : world_(std::move(parts.world)),
      scene_(world_, parts.scene),
      stands_(std::move(parts.stands)),
      plan_(std::move(parts.plan)) {
}

void EmulatedHead::plug_in(HeadDevices devices) {
  devices_ = std::move(devices);
  scene_.watch(*devices_.pointing);
  const std::initializer_list<EmulatedLine*> all = {devices_.ptu_port.get(), devices_.bus.get(),
                                                    devices_.rangefinder_port.get()};
  std::copy_if(all.begin(), all.end(), std::back_inserter(lines_),
               [](const EmulatedLine* line) { return line != nullptr; });
}

Stamp EmulatedHead::next_event() const {
  Stamp next = std::min(plan_.next(), stands_.next());
  for (const EmulatedLine* const line : lines_) {
    next = std::min(next, line->next_event());
  }
  return next;
}

Stamp EmulatedHead::next_delivery() const {
  Stamp next = hal::kNever;
  for (const EmulatedLine* const line : lines_) {
    next = std::min(next, line->next_delivery());
  }
  return next;
}

void EmulatedHead::advance(Stamp now) {
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    step(event);
  }
  for (EmulatedLine* const line : lines_) {
    line->advance(now);
  }
  clock_.now = now;
}

void EmulatedHead::step(Stamp event) {
  for (EmulatedLine* const line : lines_) {
    if (line->next_event() <= event) {
      line->advance(event);
    }
  }
  if (const auto visit = stands_.take(event)) {
    go(*visit, event);
  }
  if (const auto due = plan_.take(event)) {
    inject(*due);
  }
}

void EmulatedHead::go(const Visit& visit, Stamp at) {
  scene_.stand_at(visit.pose_W);
  visits_.push_back({at, visit});
}

bool EmulatedHead::next_stand() {
  const auto visit = stands_.next_stand();
  if (visit) {
    go(*visit, clock_.now);
  }
  return visit.has_value();
}

bool EmulatedHead::inject(std::string_view device, FaultKind kind, Stamp duration) {
  inject({std::string(device), {kind, clock_.now, duration}});
  return faults_.back().known;
}

void EmulatedHead::inject(const DueFault& due) {
  bool known = false;
  if (due.device == kCanName && devices_.bus != nullptr) {
    devices_.bus->advance(due.fault.at);
    known = devices_.bus->inject(due.fault);
  } else if (due.device == kPtuName) {
    known = inject_device(devices_.ptu_port.get(), *devices_.ptu, due.fault);
  } else if (due.device == kRangefinderName) {
    known = inject_device(devices_.rangefinder_port.get(), *devices_.rangefinder, due.fault);
  }
  faults_.push_back({due, known});
}

bool EmulatedHead::inject_device(EmulatedPort* port, EmulatedDevice& device, const Fault& fault) {
  if (port != nullptr) {
    port->advance(fault.at);
    return port->inject(fault);
  }
  devices_.bus->advance(fault.at);
  return device.inject(fault);
}

namespace {

std::unique_ptr<MemoryLink> byte_link(EmulatedPort* port, const SimClock& clock, std::uint32_t baud,
                                      double usb_s) {
  MemoryLinkConfig config;
  config.baud = baud;
  config.batch = hal::from_seconds(usb_s);
  return port != nullptr ? std::make_unique<MemoryLink>(*port, clock, config) : nullptr;
}

std::unique_ptr<MemoryCanLink> can_link(const EmulatedPort* port, MemoryCanBus* bus, const SimClock& clock) {
  return port == nullptr && bus != nullptr ? std::make_unique<MemoryCanLink>(*bus, clock) : nullptr;
}

}  // namespace

tl::expected<std::unique_ptr<InProcessHead>, WorldError> InProcessHead::create(const Scenario& scenario) {
  return create(scenario, make_head_devices);
}

tl::expected<std::unique_ptr<InProcessHead>, WorldError> InProcessHead::create(const Scenario& scenario,
                                                                               const DeviceMaker& make) {
  return EmulatedHead::create(scenario, make).map([&](std::unique_ptr<EmulatedHead> head) {
    return std::unique_ptr<InProcessHead>(new InProcessHead(std::move(head), scenario));
  });
}

InProcessHead::InProcessHead(std::unique_ptr<EmulatedHead> head, const Scenario& scenario)
    : head_(std::move(head)) {
  const PtuProfile& ptu = scenario.head.ptu;
  const RangefinderProfile& finder = scenario.head.rangefinder;
  const SimClock& clock = head_->clock();
  ptu_bytes_ = byte_link(head_->ptu_port(), clock, ptu.baud, ptu.usb_s);
  ptu_can_ = can_link(head_->ptu_port(), head_->bus(), clock);
  rangefinder_bytes_ = byte_link(head_->rangefinder_port(), clock, finder.baud, finder.usb_s);
  rangefinder_can_ = can_link(head_->rangefinder_port(), head_->bus(), clock);
}

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
