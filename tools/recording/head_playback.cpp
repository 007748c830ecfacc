#include "tools/recording/head_playback.hpp"

#include "firmware/recording/head_command.hpp"

#include <utility>

namespace slamsensor::tools {

tl::expected<std::unique_ptr<HeadPlayback>, InputError> HeadPlayback::create(ChunkSource& chunks,
                                                                             const firmware::Config& config) {
  auto playback = std::unique_ptr<HeadPlayback>(new HeadPlayback(chunks));
  return playback->start(config).map([&] { return std::move(playback); });
}

tl::expected<void, InputError> HeadPlayback::start(const firmware::Config& config) {
  auto drivers = firmware::make_head_drivers(config.head, links_.get());
  if (!drivers) {
    return refuse("the tape", "does not fit the settings: " + drivers.error().message);
  }
  drivers_ = std::move(*drivers);
  sensor_ =
      std::make_unique<firmware::SensorHead>(*drivers_.pan_tilt, *drivers_.rangefinder, config.scan_head);
  return {};
}

std::optional<firmware::HeadEvent> HeadPlayback::next() {
  for (;;) {
    if (auto event = sensor_->take()) {
      return event;
    }
    const auto operation = player_.next();
    if (!operation) {
      return std::nullopt;
    }
    if (operation->op == firmware::TapeOp::Command) {
      firmware::command(*sensor_, operation->command, operation->number);
      continue;
    }
    sensor_->step(operation->time);
    if (!player_.has_ended_step()) {
      return std::nullopt;
    }
  }
}

}  // namespace slamsensor::tools
