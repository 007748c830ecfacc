#include "tools/emulator/ptu/ptu_port.hpp"

#include "tools/emulator/ptu/cpi_command.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace slamsensor::tools {
namespace {

std::string limit_report(PtuAxisId axis, PtuForm form) {
  const bool is_pan = axis == PtuAxisId::Pan;
  if (form == PtuForm::Binary) {
    return std::string(1, static_cast<char>(is_pan ? kCpiPanLimitHit : kCpiTiltLimitHit));
  }
  return is_pan ? "!P" : "!T";
}

// Uses up one of `count`; false when none is left.
bool take_one(unsigned& count) {
  if (count == 0) {
    return false;
  }
  --count;
  return true;
}

}  // namespace

void PtuPort::send(std::string_view bytes, Stamp now) {
  if (now < silent_until_) {
    return;
  }
  const std::vector<std::uint8_t> raw(bytes.begin(), bytes.end());
  sink_.send(raw, now);
}

void PtuPort::turn_to(PtuAudience audience, Stamp now) {
  audience_ = audience;
  if (audience == PtuAudience::Host && !stored_.empty()) {
    send(std::exchange(stored_, {}), now);
  }
}

void PtuPort::say(std::string_view bytes, Stamp now) {
  if (audience_ == PtuAudience::Host && !bytes.empty()) {
    send(bytes, now);
  }
}

void PtuPort::answer(const std::string& bytes, PtuForm form, Stamp now) {
  if (bytes.empty() || take_one(swallow_)) {
    return;
  }
  std::string told = bytes;
  if (take_one(limit_inside_)) {
    const PtuAxisId axis = draw_unit(rng_) < 0.5 ? PtuAxisId::Pan : PtuAxisId::Tilt;
    const double inside = draw_uniform(rng_, 1.0, static_cast<double>(told.size()));
    told.insert(std::min(static_cast<std::size_t>(inside), told.size()), limit_report(axis, form));
  }
  if (take_one(twice_)) {
    told += std::string(told);
  }
  if (audience_ == PtuAudience::Host) {
    send(told, now);
  } else {
    stored_ += told.substr(0, capacity_ - std::min(capacity_, stored_.size()));
  }
}

void PtuPort::report(PtuAxisId axis, PtuForm form, Stamp now) {
  say(limit_report(axis, form), now);
}

void PtuPort::be_silent(Stamp until) {
  silent_until_ = std::max(silent_until_, until);
}

bool PtuPort::befall(FaultKind kind) {
  switch (kind) {
    case FaultKind::SwallowReply:
      ++swallow_;
      return true;
    case FaultKind::DoubleReply:
      ++twice_;
      return true;
    case FaultKind::LimitReport:
      ++limit_inside_;
      return true;
    default:
      return false;
  }
}

void PtuPort::cut_power() {
  stored_.clear();
  sink_.clear();
}

}  // namespace slamsensor::tools
