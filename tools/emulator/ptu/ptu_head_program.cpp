// What the head does by itself once told: presets, automatic scan, reset, loss of power.
#include "tools/emulator/ptu/ptu_head.hpp"

#include <algorithm>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr std::array kTiltFirst = {PtuAxisId::Tilt, PtuAxisId::Pan};

}  // namespace

void PtuHead::save_preset(long number, Stamp now) {
  presets_[number] = {axis(PtuAxisId::Pan).position(now), axis(PtuAxisId::Tilt).position(now)};
}

PtuVerdict PtuHead::go_to_preset(long number, Stamp now) {
  const auto found = presets_.find(number);
  if (found == presets_.end()) {
    return {PtuStatus::IllegalPosition, settings_.wording.illegal_argument};
  }
  const auto [pan, tilt] = found->second;
  PtuVerdict verdict = check_position(PtuAxisId::Tilt, tilt);
  if (verdict.status == PtuStatus::Ok) {
    verdict = set_position(PtuAxisId::Pan, pan, now);
  }
  return verdict.status == PtuStatus::Ok ? set_position(PtuAxisId::Tilt, tilt, now) : verdict;
}

PtuVerdict PtuHead::set_motion(const std::array<long, 2 * kPtuAxes>& values, Stamp now) {
  for (const PtuAxisId id : kTiltFirst) {
    PtuVerdict verdict = check_position(id, values[index_of(id)]);
    verdict = verdict.status == PtuStatus::Ok ? check_speed(id, values[kPtuAxes + index_of(id)]) : verdict;
    if (verdict.status != PtuStatus::Ok) {
      return verdict;
    }
  }
  PtuVerdict verdict;
  for (const PtuAxisId id : kTiltFirst) {
    if (verdict.status == PtuStatus::Ok) {
      verdict = set_speed(id, values[kPtuAxes + index_of(id)], now);
    }
    if (verdict.status == PtuStatus::Ok) {
      verdict = set_position(id, values[index_of(id)], now);
    }
  }
  return verdict;
}

void PtuHead::begin_monitor(Stamp now) {
  if (!config.monitor) {
    config.monitor = PtuMonitorRange{axis(PtuAxisId::Pan).min(), axis(PtuAxisId::Pan).max(), std::nullopt};
  }
  monitor_end_ = 1;
  turn_monitor(now);
}

void PtuHead::turn_monitor(Stamp now) {
  const std::size_t end = 1 - *monitor_end_;
  monitor_end_ = end;
  go(PtuAxisId::Pan, end == 0 ? config.monitor->pan_from : config.monitor->pan_to, now);
  if (config.monitor->tilt) {
    go(PtuAxisId::Tilt, (*config.monitor->tilt)[end], now);
  }
}

void PtuHead::end_monitor(Stamp now) {
  monitor_end_.reset();
  go(PtuAxisId::Pan, 0, now);
  go(PtuAxisId::Tilt, 0, now);
}

Stamp PtuHead::reset_duration(PtuAxisId id, Stamp now) const {
  const auto speed = static_cast<double>(config.reset_speeds[index_of(id)]);
  const Stamp own =
      speed > 0.0 ? hal::from_seconds(axis(id).reset_way(now) / speed) : settings_.reset_time / 2;
  return std::max(own, Stamp(1));
}

PtuReset PtuHead::begin_reset(PtuAxes axes, std::optional<PtuAxisId> jammed, Stamp now) {
  PtuReset reset{now, {}, {}};
  monitor_end_.reset();
  velocities_ = {};
  stored_ = {};
  for (const PtuAxisId id : kTiltFirst) {
    if (!(id == PtuAxisId::Pan ? axes.pan : axes.tilt)) {
      axis(id).freeze(now);
      continue;
    }
    axis(id).freeze(now);
    const bool does_jam = jammed == id;
    const Stamp duration = reset_duration(id, now);
    is_lost_[index_of(id)] = does_jam;
    const auto hits = does_jam ? axis(id).jam(reset.end, duration) : axis(id).reset(reset.end, duration);
    for (const Stamp at : hits) {
      reset.hits.push_back({at, id});
    }
    if (does_jam) {
      reset.verdict = refuse(PtuStatus::ResetFailed, settings_.wording.reset_failed, id, 0);
    }
    reset.end += duration;
  }
  is_resetting_ = true;
  return reset;
}

void PtuHead::end_reset() {
  is_resetting_ = false;
  for (const PtuAxisId id : kTiltFirst) {
    if (axis(id).target() == 0) {
      axis(id).set_step_mode(parameters(id).step_mode);
    }
  }
}

void PtuHead::cut_power(Stamp now) {
  monitor_end_.reset();
  velocities_ = {};
  stored_ = {};
  is_resetting_ = false;
  is_lost_ = {true, true};
  for (PtuAxis& own : axes_) {
    own.freeze(now);
    own.lose_position(now);
  }
}

Stamp PtuHead::still_from() const {
  return std::max(axes_[0].still_from(), axes_[1].still_from());
}

Stamp PtuHead::next_event() const {
  if (is_resetting_) {
    return hal::kNever;
  }
  const Stamp hit = std::min(axes_[0].next_stop_hit(seen_), axes_[1].next_stop_hit(seen_));
  return is_monitoring() ? std::min(hit, still_from()) : hit;
}

std::optional<PtuLimitHit> PtuHead::step(Stamp now) {
  seen_ = now;
  for (const PtuAxisId id : {PtuAxisId::Pan, PtuAxisId::Tilt}) {
    if (!is_resetting_ && axis(id).next_stop_hit(now) <= now) {
      axis(id).freeze(now);
      return PtuLimitHit{now, id};
    }
  }
  if (is_monitoring() && still_from() <= now) {
    turn_monitor(now);
  }
  return std::nullopt;
}

void PtuHead::forget(Stamp before) {
  for (PtuAxis& own : axes_) {
    own.forget(before);
  }
}

}  // namespace slamsensor::tools
