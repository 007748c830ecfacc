#include "tools/emulator/canopen/emulated_canopen_head.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::uint64_t kPanStream = 211;
constexpr std::uint64_t kTiltStream = 212;
constexpr std::uint64_t kChoiceStream = 213;

}  // namespace

EmulatedCanopenHead::EmulatedCanopenHead(const CanopenHeadSettings& settings, FrameSink& pan, FrameSink& tilt,
                                         std::uint64_t seed)
    : pan_(settings.pan, pan, mix_seed(seed, kPanStream)),
      tilt_(settings.tilt, tilt, mix_seed(seed, kTiltStream)),
      rng_(mix_seed(seed, kChoiceStream)) {
}

void EmulatedCanopenHead::advance(Stamp now) {
  pan_.advance(now);
  tilt_.advance(now);
}

Stamp EmulatedCanopenHead::next_event() const {
  return std::min(pan_.next_event(), tilt_.next_event());
}

bool EmulatedCanopenHead::inject(const Fault& fault) {
  if (fault.kind == FaultKind::PowerCycle || fault.kind == FaultKind::Silence) {
    const bool knows = pan_.inject(fault);
    return tilt_.inject(fault) && knows;
  }
  const bool pan_moves = pan_.is_moving(fault.at);
  const bool is_clear = pan_moves != tilt_.is_moving(fault.at);
  const bool is_pan = is_clear ? pan_moves : draw_unit(rng_) < 0.5;
  return (is_pan ? pan_ : tilt_).inject(fault);
}

HeadAngles EmulatedCanopenHead::angles_at(Stamp at) const {
  return {pan_.angle_rad(at), tilt_.angle_rad(at)};
}

}  // namespace slamsensor::tools
