#include "tools/emulator/emulated_head.hpp"

#include "tools/emulator/make_head_devices.hpp"
#include "tools/emulator/scenario.hpp"
#include "tools/world/section.hpp"

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <string>
#include <utility>

namespace slamsensor::tools {
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
  config.rangefinder.drop_out_share = 0.0;  // the scene tells lost shots from empty ones
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
      return tl::unexpected(WorldError{"the kidnap at " + text_of(kidnap.at_s) +
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
  const std::initializer_list<DeviceLine*> all = {devices_.ptu_port.get(), devices_.bus.get(),
                                                  devices_.rangefinder_port.get()};
  std::copy_if(all.begin(), all.end(), std::back_inserter(lines_),
               [](const DeviceLine* line) { return line != nullptr; });
}

Stamp EmulatedHead::next_event() const {
  Stamp next = std::min(plan_.next(), stands_.next());
  for (const DeviceLine* const line : lines_) {
    next = std::min(next, line->next_event());
  }
  return next;
}

Stamp EmulatedHead::next_delivery() const {
  Stamp next = hal::kNever;
  for (const DeviceLine* const line : lines_) {
    next = std::min(next, line->next_delivery());
  }
  return next;
}

void EmulatedHead::advance(Stamp now) {
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    step(event);
  }
  for (DeviceLine* const line : lines_) {
    line->advance(now);
  }
  clock_.now = now;
}

void EmulatedHead::step(Stamp event) {
  for (DeviceLine* const line : lines_) {
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

}  // namespace slamsensor::tools
