#include "firmware/daemon/head_runtime.hpp"

namespace slamsensor::firmware {

tl::expected<std::unique_ptr<HeadRuntime>, std::string> HeadRuntime::create(const Config& config,
                                                                            TapeWriter* tape) {
  auto links = open_head_links(config.head);
  if (!links) {
    return tl::unexpected(links.error().message);
  }
  std::unique_ptr<HeadRuntime> runtime(new HeadRuntime(std::move(*links)));
  if (tape != nullptr) {
    runtime->tape_ = tape;
    runtime->taps_.emplace(runtime->links_.get()).attach(tape);
  }
  auto drivers =
      make_head_drivers(config.head, tape != nullptr ? runtime->taps_->get() : runtime->links_.get());
  if (!drivers) {
    return tl::unexpected(drivers.error().message);
  }
  runtime->drivers_ = std::move(*drivers);
  runtime->head_ = std::make_unique<SensorHead>(*runtime->drivers_.pan_tilt, *runtime->drivers_.rangefinder,
                                                config.scan_head);
  return runtime;
}

void HeadRuntime::leave_tape() noexcept {
  if (taps_) {
    taps_->attach(nullptr);  // the drivers stay on them, and the devices at work
  }
  tape_ = nullptr;
}

}  // namespace slamsensor::firmware
