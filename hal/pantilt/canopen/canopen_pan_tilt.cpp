#include "hal/pantilt/canopen/canopen_pan_tilt.hpp"

#include <utility>

namespace slamsensor::hal {
namespace {

constexpr std::size_t kFramesPerStep = 256;  // 25 ms of a full bus at 1 Mbit/s

constexpr std::string_view kBusDown =
    "CANopen pan-tilt unit: the CAN bus is down; check the interface, its cable and its termination";

}  // namespace

tl::expected<std::unique_ptr<CanopenPanTilt>, InitError> CanopenPanTilt::create(const CanopenConfig& config,
                                                                                CanLink& link) {
  if (std::optional<InitError> error = canopen_config_error(config)) {
    return tl::unexpected(std::move(*error));
  }
  return std::unique_ptr<CanopenPanTilt>(new CanopenPanTilt(config, link));
}

CanopenPanTilt::CanopenPanTilt(const CanopenConfig& config, CanLink& link) noexcept
    : config_(config),
      link_(link),
      pan_(Axis::Pan, config_, link, counters_, samples_),
      tilt_(Axis::Tilt, config_, link, counters_, samples_) {
}

void CanopenPanTilt::step(Stamp now) noexcept {
  if (!link_ready(now)) {
    return;
  }
  receive(now);
  pan_.step(now);
  tilt_.step(now);
  send_sync(now);
  update_state();
}

std::string_view CanopenPanTilt::problem() const noexcept {
  if (state_ == DeviceState::Ready) {
    return {};
  }
  if (state_ == DeviceState::Absent) {
    return link_.problem().empty() ? kBusDown : link_.problem();
  }
  // The axis in the worse state is the one to look at first.
  const bool tilt_first = pan_.state() == DeviceState::Ready ||
                          (tilt_.state() == DeviceState::Faulted && pan_.state() != DeviceState::Faulted);
  return tilt_first ? problem_text(Axis::Tilt, tilt_.problem()) : problem_text(Axis::Pan, pan_.problem());
}

MoveStatus CanopenPanTilt::move(Axis axis, double target_rad, double speed_radps) noexcept {
  MoveStatus result = MoveStatus::NotReady;
  if (state_ == DeviceState::Ready) {
    result = (axis == Axis::Pan ? pan_ : tilt_).drive().ask(target_rad, speed_radps);
  }
  counters_.count(CanopenEvent::MovesRefused, result == MoveStatus::Accepted ? 0 : 1);
  return result;
}

MoveStatus CanopenPanTilt::halt() noexcept {
  if (state_ != DeviceState::Ready) {
    counters_.count(CanopenEvent::MovesRefused);
    return MoveStatus::NotReady;
  }
  pan_.drive().halt();
  tilt_.drive().halt();
  return MoveStatus::Accepted;
}

const AxisStatus& CanopenPanTilt::axis(Axis axis) const noexcept {
  return (axis == Axis::Pan ? pan_ : tilt_).drive().status();
}

bool CanopenPanTilt::link_ready(Stamp now) noexcept {
  link_.service(now);
  if (!link_.is_up()) {
    if (state_ != DeviceState::Absent) {
      pan_.lose_link();
      tilt_.lose_link();
      state_ = DeviceState::Absent;
    }
    return false;
  }
  if (epoch_ != link_.epoch() || state_ == DeviceState::Absent) {
    counters_.count(CanopenEvent::Restarts, epoch_ != 0 ? 2 : 0);
    epoch_ = link_.epoch();
    pan_.begin(now);
    tilt_.begin(now);
    state_ = DeviceState::Starting;
  }
  return true;
}

void CanopenPanTilt::receive(Stamp now) noexcept {
  for (std::size_t i = 0; i < kFramesPerStep; ++i) {
    const CanRead got = link_.receive();
    if (got.status != LinkStatus::Ok) {
      return;
    }
    pan_.on_frame(got, now);
    tilt_.on_frame(got, now);
  }
}

/// Keeps the beat of the SYNC; after a pause it begins anew instead of catching up.
void CanopenPanTilt::send_sync(Stamp now) noexcept {
  if ((!pan_.wants_sync() && !tilt_.wants_sync()) || now < next_sync_) {
    return;
  }
  if (link_.send(CanFrame{.id = cob::kSync}) != LinkStatus::Ok) {
    counters_.count(CanopenEvent::SendsBusy);
    return;
  }
  const Stamp period = from_seconds(1.0 / config_.poll_hz);
  const bool begun = next_sync_ != Stamp::min();
  const bool late = begun && now - next_sync_ >= period;
  counters_.count(CanopenEvent::SyncsLate, late ? 1 : 0);
  next_sync_ = begun && !late ? next_sync_ + period : now + period;
  pan_.on_sync(now);
  tilt_.on_sync(now);
}

void CanopenPanTilt::update_state() noexcept {
  const bool ready = pan_.state() == DeviceState::Ready && tilt_.state() == DeviceState::Ready;
  const bool faulted = pan_.state() == DeviceState::Faulted || tilt_.state() == DeviceState::Faulted;
  const DeviceState before = state_;
  state_ = ready ? DeviceState::Ready : faulted ? DeviceState::Faulted : DeviceState::Starting;
  if (ready && before != DeviceState::Ready) {
    info_.pan = pan_.facts().info;
    info_.tilt = tilt_.facts().info;
    info_.model = pan_.facts().name;
  }
  if (!ready && before == DeviceState::Ready) {
    samples_.clear();
    // One axis alone is of no use: the other stops, too.
    for (CanopenNode* node : {&pan_, &tilt_}) {
      if (node->state() == DeviceState::Ready) {
        node->drive().halt();
      }
    }
  }
}

}  // namespace slamsensor::hal
