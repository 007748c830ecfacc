#pragma once

#include "hal/transport/byte_link.hpp"
#include "hal/transport/can_link.hpp"
#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/emulated_port.hpp"
#include "tools/emulator/fault.hpp"
#include "tools/emulator/head_devices.hpp"
#include "tools/emulator/memory_can_bus.hpp"
#include "tools/emulator/scenario.hpp"
#include "tools/output/text_output.hpp"
#include "tools/world/random.hpp"
#include "tools/world/simulate.hpp"
#include "tools/world/world.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// The truth of one reading that went out.
struct ShotTruth {
  Stamp measured{};   ///< when the laser fired
  Stamp on_wire{};    ///< when the device began to send the reading
  HeadAngles angles;  ///< of the head when the laser fired
  Target target;      ///< what the device was given to measure
};

struct HeadSceneConfig {
  SweepConfig mount;            ///< height, roll and pitch of the mount; the rest is not used
  double drop_out_share = 0.0;  ///< chance that a shot is lost; the world's own should be 0
  std::uint64_t seed = 1;       ///< of noise and drop-outs
  std::size_t truth_max = 0;    ///< readings whose truth is kept; the oldest go first
};

/// The world as the rangefinder on a pan-tilt unit sees it: every shot goes where the unit truly points at
/// that moment, from the place where the sensor then stands.
class HeadScene final : public RangeScene {
 public:
  /// `world` outlives the scene.
  HeadScene(const World& world, const HeadSceneConfig& config);

  /// Shots go where `pointing` says from now on; it outlives the scene's use. Before: straight ahead.
  void watch(const PointingTruth& pointing) { pointing_ = &pointing; }

  /// The mount stands at `pose_W` from now on.
  void stand_at(const core::Pose2& pose_W);

  [[nodiscard]] Target shoot(Stamp at) override;
  void reported(Stamp measured, Stamp on_wire) override;

  /// Moves out the truth of the readings reported since the last call, in the order of time, at most
  /// `truth_max`.
  [[nodiscard]] std::vector<ShotTruth> take_truth();

 private:
  const World& world_;
  HeadSceneConfig config_;
  SensorPlace place_;
  const PointingTruth* pointing_ = nullptr;
  Random noise_;
  Random drop_outs_;
  std::deque<ShotTruth> pending_;  // fired and not yet reported
  std::deque<ShotTruth> truth_;
};

/// A plausible reflectance of `surface` in the near infrared, 0 to 1.
[[nodiscard]] double reflectance_of(Surface surface) noexcept;

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
  std::vector<EmulatedLine*> lines_;  // the unit's before the rangefinder's
  SimClock clock_;
  std::vector<VisitRecord> visits_;
  std::vector<FaultRecord> faults_;
};

/// An EmulatedHead with links for the drivers of its devices, all in simulated time:
///
///     auto run = InProcessHead::create(scenario);              // refused: error().message
///     hal::Ptu ptu(*(*run)->ptu_bytes(), config);              // a driver on its link
///     while ((*run)->now() < end) {
///       (*run)->advance((*run)->now() + std::chrono::milliseconds(1));
///       ptu.step((*run)->now());
///       if (scan_has_ended) (*run)->head().next_stand();
///     }
class InProcessHead {
 public:
  [[nodiscard]] static tl::expected<std::unique_ptr<InProcessHead>, WorldError> create(
      const Scenario& scenario);
  [[nodiscard]] static tl::expected<std::unique_ptr<InProcessHead>, WorldError> create(
      const Scenario& scenario, const DeviceMaker& make);

  [[nodiscard]] EmulatedHead& head() noexcept { return *head_; }
  [[nodiscard]] Stamp now() const noexcept { return head_->clock().now; }

  /// Everything up to `now` has happened; what has arrived by then can be read from the links.
  void advance(Stamp now) { head_->advance(now); }

  /// The link to a device: bytes or CAN frames, the other one null.
  [[nodiscard]] hal::ByteLink* ptu_bytes() noexcept { return ptu_bytes_.get(); }
  [[nodiscard]] hal::CanLink* ptu_can() noexcept { return ptu_can_.get(); }
  [[nodiscard]] hal::ByteLink* rangefinder_bytes() noexcept { return rangefinder_bytes_.get(); }
  [[nodiscard]] hal::CanLink* rangefinder_can() noexcept { return rangefinder_can_.get(); }

 private:
  InProcessHead(std::unique_ptr<EmulatedHead> head, const Scenario& scenario);

  std::unique_ptr<EmulatedHead> head_;
  std::unique_ptr<MemoryLink> ptu_bytes_;
  std::unique_ptr<MemoryLink> rangefinder_bytes_;
  std::unique_ptr<MemoryCanLink> ptu_can_;
  std::unique_ptr<MemoryCanLink> rangefinder_can_;
};

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
