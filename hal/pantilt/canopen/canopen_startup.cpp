#include "hal/pantilt/canopen/canopen_startup.hpp"

namespace slamsensor::hal {

CanopenStartup::CanopenStartup(const CanopenConfig& config, const CanopenAxisConfig& axis, CanLink& link,
                               SdoClient& sdo, CanopenCounters& counters) noexcept
    : config_(config),
      axis_(axis),
      link_(link),
      sdo_(sdo),
      counters_(counters),
      facts_(config, axis, counters),
      settings_(config, axis, counters),
      receive_(PdoDirection::Receive, axis.node, config, counters),
      transmit_(PdoDirection::Transmit, axis.node, config, counters),
      enable_(config),
      reference_(config, axis) {
}

void CanopenStartup::begin(Stamp now) noexcept {
  enter(Stage::Stop, now);
}

CanopenProblem CanopenStartup::step(Stamp now) noexcept {
  if (stage_ == Stage::Stop || stage_ == Stage::Start) {
    step_nmt(stage_ == Stage::Stop ? NmtCommand::PreOperational : NmtCommand::Start, now);
    return CanopenProblem::None;
  }
  CanopenScript* const part = script();
  if (part == nullptr) {
    return CanopenProblem::None;
  }
  if (const std::optional<SdoResult> result = sdo_.take()) {
    const CanopenProblem problem = result->outcome == SdoOutcome::TimedOut
                                       ? CanopenProblem::NoReply
                                       : part->on_result(*result, sdo_, now);
    if (problem != CanopenProblem::None) {
      return problem;
    }
  }
  if (!sdo_.is_idle()) {
    return CanopenProblem::None;
  }
  if (const std::optional<SdoRequest> request = part->next()) {
    sdo_.begin(*request, now);
  } else {
    enter(static_cast<Stage>(static_cast<std::uint8_t>(stage_) + 1), now);
  }
  return CanopenProblem::None;
}

CanopenScript* CanopenStartup::script() noexcept {
  switch (stage_) {
    case Stage::Facts:
      return &facts_;
    case Stage::Settings:
      return &settings_;
    case Stage::Receive:
      return &receive_;
    case Stage::Transmit:
      return &transmit_;
    case Stage::Enable:
      return &enable_;
    case Stage::Reference:
      return &reference_;
    case Stage::Stop:
    case Stage::Start:
    case Stage::Done:
      break;
  }
  return nullptr;
}

void CanopenStartup::enter(Stage stage, Stamp now) noexcept {
  stage_ = stage;
  nmt_sent_ = false;
  if (stage == Stage::Settings) {
    const double own = axis_.acceleration_units_per_rad;
    settings_.set_scale(own > 0.0 ? own : 1.0 / facts().info.resolution_rad);
  }
  if (stage == Stage::Reference) {
    reference_.set_modes(facts().modes);
  }
  if (CanopenScript* const part = script()) {
    part->begin(now);
  }
}

/// A node confirms no such command; it is given time to act on it.
void CanopenStartup::step_nmt(NmtCommand command, Stamp now) noexcept {
  if (!nmt_sent_) {
    nmt_sent_ = link_.send(nmt_frame(command, axis_.node)) == LinkStatus::Ok;
    counters_.count(CanopenEvent::SendsBusy, nmt_sent_ ? 0 : 1);
    resume_ = now + config_.boot_wait;
  } else if (now >= resume_) {
    enter(static_cast<Stage>(static_cast<std::uint8_t>(stage_) + 1), now);
  }
}

}  // namespace slamsensor::hal
