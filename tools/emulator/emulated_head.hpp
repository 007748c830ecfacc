#pragma once

#include "tools/emulator/fault_plan.hpp"
#include "tools/emulator/head_devices.hpp"
#include "tools/emulator/head_scene.hpp"
#include "tools/emulator/sim_clock.hpp"
#include "tools/emulator/stand_plan.hpp"
#include "tools/world/world.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

struct Scenario;

/// What happened to the head.
struct VisitRecord {
  Stamp at{};
  Visit visit;
};
struct FaultRecord {
  DueFault due;
  bool known = false;  ///< false: neither the line nor the device has such a fault; nothing happened
};

/// Builds the devices of a head that shoot into `scene`, or says why they cannot be.
using DeviceMaker =
    std::function<tl::expected<HeadDevices, WorldError>(const Scenario& scenario, RangeScene& scene)>;

/// A sensor head in a simulated world: the devices of a scenario, their lines, where the sensor stands, and
/// what goes wrong. Everything happens in the order of time; equal scenarios and calls give equal bytes.
class EmulatedHead {
 public:
  /// The head of `scenario` at time 0, switched on and at its first stand, with the devices of its profile;
  /// refused when the world or a place to stand is not possible.
  [[nodiscard]] static tl::expected<std::unique_ptr<EmulatedHead>, WorldError> create(
      const Scenario& scenario);

  /// The same with devices from `make`.
  [[nodiscard]] static tl::expected<std::unique_ptr<EmulatedHead>, WorldError> create(
      const Scenario& scenario, const DeviceMaker& make);

  /// The time to which everything has happened.
  [[nodiscard]] const SimClock& clock() const noexcept { return clock_; }

  /// The earliest time at which something happens; the earliest at which bytes or frames reach the host.
  [[nodiscard]] Stamp next_event() const;
  [[nodiscard]] Stamp next_delivery() const;

  /// Everything up to and including `now` happens, in order; the clock is then at `now`, which never
  /// decreases.
  void advance(Stamp now);

  /// The sensor is at the next stand from now on; false, and it stays, when there is none.
  bool next_stand();

  /// Injects a fault now, beside those of the scenario; false when nothing of that name has such a fault.
  bool inject(std::string_view device, FaultKind kind, Stamp duration);

  /// Null when the device is on the bus, or there is no bus.
  [[nodiscard]] EmulatedPort* ptu_port() noexcept { return devices_.ptu_port.get(); }
  [[nodiscard]] EmulatedPort* rangefinder_port() noexcept { return devices_.rangefinder_port.get(); }
  [[nodiscard]] MemoryCanBus* bus() noexcept { return devices_.bus.get(); }

  [[nodiscard]] const World& world() const noexcept { return world_; }
  [[nodiscard]] const StandPlan& stands() const noexcept { return stands_; }
  [[nodiscard]] const PointingTruth& pointing() const noexcept { return *devices_.pointing; }

  /// Where the sensor has been and what was injected so far.
  [[nodiscard]] std::span<const VisitRecord> visits() const noexcept { return visits_; }
  [[nodiscard]] std::span<const FaultRecord> faults() const noexcept { return faults_; }

  /// As HeadScene::take_truth().
  [[nodiscard]] std::vector<ShotTruth> take_truth() { return scene_.take_truth(); }

 private:
  struct Parts {
    World world;
    HeadSceneConfig scene;
    StandPlan stands;
    FaultPlan plan;
  };

  explicit EmulatedHead(Parts parts);

  [[nodiscard]] static tl::expected<Parts, WorldError> parts_of(const Scenario& scenario);

  void plug_in(HeadDevices devices);
  void step(Stamp event);
  void go(const Visit& visit, Stamp at);
  void inject(const DueFault& due);
  [[nodiscard]] bool inject_device(EmulatedPort* port, EmulatedDevice& device, const Fault& fault);

  World world_;
  HeadScene scene_;
  StandPlan stands_;
  FaultPlan plan_;
  HeadDevices devices_;
  std::vector<DeviceLine*> lines_;  // the unit's before the rangefinder's
  SimClock clock_;
  std::vector<VisitRecord> visits_;
  std::vector<FaultRecord> faults_;
};

}  // namespace slamsensor::tools
