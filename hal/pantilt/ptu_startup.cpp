#include "hal/pantilt/ptu_startup.hpp"

namespace slamsensor::hal {
namespace {

constexpr int kSameAnswers = 2 * 3;  // three rounds of two axes

}  // namespace

void PtuRest::restart() noexcept {
  next_ = Axis::Pan;
  rounds_ = 0;
}

void PtuRest::answer(std::int32_t position) noexcept {
  std::int32_t& before = positions_[static_cast<std::size_t>(next_)];
  rounds_ = position == before ? rounds_ + 1 : 0;
  before = position;
  next_ = next_ == Axis::Pan ? Axis::Tilt : Axis::Pan;
}

bool PtuRest::resting() const noexcept {
  return rounds_ >= kSameAnswers && next_ == Axis::Pan;
}

namespace {

constexpr std::string_view kResting = "pan-tilt unit: waiting until it rests";
constexpr std::string_view kRefusesPositions =
    "pan-tilt unit: it refuses the queries PP and TP for its positions; check that both axes are connected "
    "to it";
constexpr std::string_view kRefusesFacts =
    "pan-tilt unit: it refuses queries for its limits, speeds or resolution; check that both axes are "
    "connected "
    "to it, and its firmware";
constexpr std::string_view kResetting = "pan-tilt unit: it is resetting";
constexpr std::string_view kSettingUp = "pan-tilt unit: setting it up";
constexpr std::string_view kRestless =
    "pan-tilt unit: it does not come to rest; check that nothing else commands it";
constexpr std::string_view kImpossible =
    "pan-tilt unit: it reports impossible limits, speeds or resolution; reset it, or allow reset at start";
constexpr std::string_view kResetFailed =
    "pan-tilt unit: its reset failed; check that both axes turn freely and its supply voltage";

constexpr std::uint32_t kSettlesMax = 5;  // a unit may not know how to be silent or terse
constexpr std::uint32_t kResetsMax = 2;
constexpr Stamp kRestPoll = std::chrono::milliseconds(100);
constexpr Stamp kLimitsQuiet = std::chrono::seconds(1);
constexpr Stamp kUnseen = std::chrono::milliseconds(1500);  // no reset, with its four ways, is that short

}  // namespace

PtuStartup::PtuStartup(ByteLink& link, const PtuConfig& config, PtuCounters& counters, PtuExchange& exchange)
    : config_(config),
      counters_(counters),
      exchange_(exchange),
      finder_(link, config, counters, exchange),
      reset_wanted_(config.reset == PtuReset::Always) {
}

void PtuStartup::begin(Stamp now) noexcept {
  resets_ = 0;
  settled_again_ = 0;
  reset_done_ = false;
  finder_.begin(now);
  enter(Phase::Finding, now);
}

void PtuStartup::begin_powered(Stamp now) noexcept {
  begin(now);
  finder_.await_reset(now);
}

PtuStartup::Progress PtuStartup::step(Stamp now, const PtuExchange::Notices& notices) noexcept {
  heed(notices, now);
  if (phase_ == Phase::Faulted && now >= wait_until_) {
    begin(now);
  }
  if (exchange_.lost() && phase_ < Phase::Done && (phase_ != Phase::Finding || finder_.is_asking())) {
    finder_.fail(now);
    enter(Phase::Finding, now);
  }
  if (const std::optional<PtuAnswer> answer = exchange_.take_answer()) {
    on_answer(*answer, now);
  }
  if ((notices.echo || notices.verbose) && settled_again_ < kSettlesMax && phase_ > Phase::Finding &&
      phase_ < Phase::Done) {
    // What confirmed the settings was something else, like the end of a reset.
    ++settled_again_;
    settle_again(now);
  }
  if (phase_ == Phase::Finding) {
    finder_.step(now);
    if (finder_.found()) {
      enter(Phase::Independent, now);
    }
  }
  if (phase_ != Phase::Finding && now >= wait_until_ && exchange_.ready(now)) {
    send_next(now);
  }
  if (phase_ == Phase::Done) {
    return Progress::Done;
  }
  return phase_ == Phase::Faulted ? Progress::Faulted : Progress::Running;
}

std::string_view PtuStartup::problem() const noexcept {
  switch (phase_) {
    case Phase::Finding:
      return finder_.problem();
    case Phase::Rest:
      return kResting;
    case Phase::Reset:
      return kResetting;
    case Phase::Faulted:
      return fault_;
    case Phase::Done:
      return {};
    default:
      return kSettingUp;
  }
}

void PtuStartup::enter(Phase phase, Stamp now) noexcept {
  phase_ = phase;
  wait_until_ = now;
  if (phase == Phase::Rest) {
    rest_.restart();
    rest_end_ = now + config_.reset_timeout;
  } else if (phase == Phase::Facts) {
    inquiry_.restart();
  }
}

/// What was confirmed before may have been confirmed by the wrong reply.
void PtuStartup::settle_again(Stamp now) noexcept {
  finder_.settle(now);
  enter(Phase::Finding, now);
}

void PtuStartup::heed(const PtuExchange::Notices& notices, Stamp now) noexcept {
  finder_.heed(notices, now);
  if (notices.marks > 0) {
    limit_ = now;
    rest_.disturb();
  }
  if (notices.marks > 0 || notices.banner) {
    reset_done_ = false;  // after ours it resets once more, and nobody knows how that goes
  }
  if (notices.banner) {
    finder_.await_reset(now);
    enter(Phase::Finding, now);
  }
}

void PtuStartup::send_next(Stamp now) noexcept {
  if (phase_ == Phase::Halt && !limits_quiet(now)) {
    enter(Phase::Limits, now);  // a halt could end a reset half-way
  }
  const std::optional<PtuCommand> command = next_command();
  if (!command) {
    return;
  }
  Stamp timeout = command->expect() == PtuExpect::Setting ? config_.mode_timeout : config_.query_timeout;
  timeout = phase_ == Phase::Reset ? config_.reset_timeout : timeout;
  if (exchange_.send(*command, timeout, now) && phase_ == Phase::Reset) {
    ++resets_;
  }
}

std::optional<PtuCommand> PtuStartup::next_command() const noexcept {
  switch (phase_) {
    case Phase::Independent:
      return PtuCommand("CI", PtuExpect::Setting);
    case Phase::Immediate:
      return PtuCommand("I", PtuExpect::Setting);
    case Phase::Halt:
      return PtuCommand("H", PtuExpect::Setting);
    case Phase::Limits:
      return PtuCommand("LE", PtuExpect::Setting);
    case Phase::Rest:
      return PtuCommand::query(rest_.next(), PtuQuantity::Position);
    case Phase::Facts:
      return inquiry_.question();
    case Phase::Reset:
      return PtuCommand("R", PtuExpect::Setting);
    default:
      return std::nullopt;
  }
}

void PtuStartup::on_answer(const PtuAnswer& answer, Stamp now) noexcept {
  if (answer.outcome == PtuOutcome::Done) {
    reset_done_ = reset_done_ && now < seen_ + kUnseen;
    seen_ = now;
  }
  switch (phase_) {
    case Phase::Finding:
      finder_.on_answer(answer, now);
      return;
    case Phase::Rest:
      on_rest(answer, now);
      return;
    case Phase::Facts:
      on_fact(answer, now);
      return;
    case Phase::Reset:
      on_reset(answer, now);
      return;
    default:
      on_setting(answer, now);
      return;
  }
}

void PtuStartup::on_setting(const PtuAnswer& answer, Stamp now) noexcept {
  if (phase_ > Phase::Limits) {
    return;
  }
  if (answer.outcome == PtuOutcome::Failed) {
    settle_again(now);
    return;
  }
  counters_.count(PtuEvent::SettingsRefused, answer.outcome == PtuOutcome::Refused ? 1 : 0);
  enter(static_cast<Phase>(static_cast<std::uint8_t>(phase_) + 1), now);
}

void PtuStartup::on_rest(const PtuAnswer& answer, Stamp now) noexcept {
  wait_until_ = now + kRestPoll;
  if (answer.outcome == PtuOutcome::Done) {
    rest_.answer(static_cast<std::int32_t>(answer.value));
  } else {
    rest_.restart();
  }
  refused_ = answer.outcome == PtuOutcome::Refused;
  if (rest_.resting() && limits_quiet(now)) {
    enter(Phase::Facts, now);
  } else if (now >= rest_end_) {
    fault(refused_ ? kRefusesPositions : kRestless, now);
  }
}

void PtuStartup::on_fact(const PtuAnswer& answer, Stamp now) noexcept {
  if (answer.outcome == PtuOutcome::Failed) {
    settle_again(now);
  } else if (answer.outcome == PtuOutcome::Refused) {
    inquiry_.restart();
    refused_ = true;
    judge_facts(now);
  } else {
    refused_ = false;
    inquiry_.answer(answer.value);
    if (inquiry_.done()) {
      judge_facts(now);
    }
  }
}

void PtuStartup::judge_facts(Stamp now) noexcept {
  const bool possible = take_facts();
  counters_.count(PtuEvent::FactsRefused, possible ? 0 : 1);
  const bool went_home = is_away_ && position(Axis::Pan) == 0 && position(Axis::Tilt) == 0;
  const bool in_doubt = (went_home || !possible) && config_.reset != PtuReset::Never;
  const bool reset = !reset_done_ && (reset_wanted_ || in_doubt);
  if (reset && resets_ >= kResetsMax) {
    fault(refused_ ? kRefusesFacts : kResetFailed, now);
  } else if (reset) {
    enter(Phase::Reset, now);
  } else if (!possible) {
    fault(refused_ ? kRefusesFacts : kImpossible, now);
  } else {
    reset_wanted_ = config_.reset == PtuReset::Always;
    is_away_ = false;
    enter(Phase::Done, now);
  }
}

/// Whether the answers are possible, and both axes stand within what they say.
bool PtuStartup::take_facts() noexcept {
  const std::optional<PtuAxisFacts> pan = inquiry_.facts(Axis::Pan);
  const std::optional<PtuAxisFacts> tilt = inquiry_.facts(Axis::Tilt);
  if (!pan || !tilt) {
    return false;
  }
  pan_ = *pan;
  tilt_ = *tilt;
  const auto stands_within = [this](Axis axis) {
    return position(axis) >= facts(axis).min_position && position(axis) <= facts(axis).max_position;
  };
  return stands_within(Axis::Pan) && stands_within(Axis::Tilt);
}

void PtuStartup::on_reset(const PtuAnswer& answer, Stamp now) noexcept {
  // Limit reports without the final `*` may be those of a reset that failed: only the whole answer counts.
  reset_done_ = answer.outcome == PtuOutcome::Done;
  counters_.count(PtuEvent::ResetsFailed, reset_done_ ? 0 : 1);
  settle_again(now);
}

void PtuStartup::fault(std::string_view problem, Stamp now) noexcept {
  fault_ = problem;
  enter(Phase::Faulted, now);
  wait_until_ = now + config_.retry_wait;
}

bool PtuStartup::limits_quiet(Stamp now) const noexcept {
  return !limit_ || now >= *limit_ + kLimitsQuiet;
}

}  // namespace slamsensor::hal
