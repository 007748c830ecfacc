// The way of a scan, station by station. Each arrow is a value.
//
//   scan thread      SensorHead::step       bytes -> drivers (hal) -> range and pan-tilt samples
//                                           -> core::ScanAssembler -> a scanline of readings; ScanScheduler
//                                           commands the sweeps meanwhile
//                    SensorHead::take       -> HeadEvent: begun, scanline, ended, aborted
//                    ScanQueue              -> the SLAM thread
//   SLAM thread      Pipeline::take         scanlines -> core::LandmarkDetector -> landmarks of the scan
//                                           -> core::associate -> core::judge -> core::Atlas -> fix
//                    SlamOutlets            -> the publish thread
//   publish thread   PublishLoop::answer    fix -> SensorTracker -> FixReport -> NmeaPublisher, LcmPublisher
#include "firmware/pipeline.hpp"

#include <variant>

namespace slamsensor::firmware {

std::optional<core::Fix> Pipeline::take(const HeadEvent& event, hal::Stamp utc_ahead,
                                        const core::Deadline& deadline) noexcept {
  if (const auto* line = std::get_if<Scanline>(&event)) {
    slam_->add_scanline(line->readings);
    return std::nullopt;
  }
  if (const auto* scan = std::get_if<ScanEnded>(&event)) {
    const core::ScanTime time{scan->begin + utc_ahead, scan->middle + utc_ahead, scan->end + utc_ahead,
                              scan->end};
    return slam_->finish_scan(time, deadline);
  }
  slam_->drop_scan();  // given up; or a new one begins, and the end of the last one was lost
  return std::nullopt;
}

core::MapCheck Pipeline::carry_out(MapCommand command, const core::MapState& state, core::Frozen frozen,
                                   MapSnapshot& room) noexcept {
  switch (command) {
    case MapCommand::Reset:
      slam_->reset();
      break;
    case MapCommand::Restore: {
      const core::MapCheck check = slam_->restore(state);
      if (check.ok() && frozen == core::Frozen::Yes) {
        slam_->set_frozen(core::Frozen::Yes);
      }
      return check;
    }
    case MapCommand::Freeze:
      slam_->set_frozen(core::Frozen::Yes);
      break;
    case MapCommand::Unfreeze:
      slam_->set_frozen(core::Frozen::No);
      break;
    case MapCommand::DropRivals:
      begin_from_home_map(room);
      break;
  }
  return {};
}

/// Goes on with what a recording holds of the maps, as its replay will.
void Pipeline::begin_from_home_map(MapSnapshot& room) noexcept {
  if (slam_->atlas() == nullptr) {
    slam_->drop_rivals();
    return;
  }
  // Not all that a map is restored from can be copied from the restored one again: the second time it is the
  // same.
  for (int time = 0; time < 2; ++time) {
    room.take(*slam_);
    slam_->reset();
    if (!room.empty()) {
      static_cast<void>(slam_->restore(room.state()));
    }
  }
}

}  // namespace slamsensor::firmware
