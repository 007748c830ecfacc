#include "hal/pantilt/ptu_driver.hpp"

#include "hal/text_writer.hpp"

#include <cmath>
#include <utility>

namespace slamsensor::hal {
namespace {

constexpr std::uint32_t kRefusedPollsMax = 5;  // in a row; one may be a lost byte

constexpr std::uint32_t kSettingTries = 3;  // then the unit, or the line, is taken as it is
constexpr double kLatenessTold = 0.3;       // share: smaller changes are not told anew
constexpr std::uint64_t kNoiseTold = 10;    // times: as above

constexpr std::string_view kEchoes =
    "pan-tilt unit: commands come back although ED turned the echo off; an adapter that hears itself? They "
    "are taken out of the replies";
constexpr std::string_view kSentences =
    "pan-tilt unit: it answers in sentences although FT turned them off; they are read as they are";
constexpr std::string_view kStartedAnew = "pan-tilt unit: it started anew by itself; check its power";
constexpr std::string_view kNoAnswers =
    "pan-tilt unit: command after command was lost or garbled; check its power and cable";
constexpr std::string_view kAxisError =
    "pan-tilt unit: it reports an axis error; check that both axes turn freely";
constexpr std::string_view kRefusesPolls = "pan-tilt unit: it refuses the queries for its position";
constexpr std::string_view kStrangePosition =
    "pan-tilt unit: it is where no move of it ends; check its power, and that nothing else moves it";
constexpr std::string_view kLineDown =
    "pan-tilt unit: its serial line is down; check the adapter and its cable";

}  // namespace

tl::expected<std::unique_ptr<PtuDriver>, InitError> PtuDriver::create(const PtuConfig& config,
                                                                      ByteLink& link) {
  if (std::optional<InitError> error = ptu_config_error(config)) {
    return tl::unexpected(std::move(*error));
  }
  return std::unique_ptr<PtuDriver>(new PtuDriver(config, link));
}

PtuDriver::PtuDriver(const PtuConfig& config, ByteLink& link)
    : config_(config),
      link_(link),
      exchange_(link, config_, counters_),
      startup_(link, config_, counters_, exchange_),
      pan_(Axis::Pan, config_, counters_, samples_),
      tilt_(Axis::Tilt, config_, counters_, samples_) {
}

void PtuDriver::step(Stamp now) noexcept {
  lost_because_ = {};
  if (!link_ready(now)) {
    return;
  }
  exchange_.step(now);
  const PtuExchange::Notices notices = exchange_.take_notices();
  if (state_ == DeviceState::Ready) {
    step_ready(now, notices);
  } else {
    step_starting(now, notices);
  }
  judge_line();
}

std::string_view PtuDriver::problem() const noexcept {
  if (state_ == DeviceState::Ready) {
    return {};
  }
  if (state_ == DeviceState::Absent) {
    return link_.problem().empty() ? kLineDown : link_.problem();
  }
  if (!lost_because_.empty()) {
    return lost_because_;
  }
  const bool is_of_line = state_ == DeviceState::Starting && trouble_ != PtuLineHealth::Trouble::None;
  return is_of_line ? trouble_text_.view() : startup_.problem();
}

MoveStatus PtuDriver::move(Axis axis, double target_rad, double speed_radps) noexcept {
  const MoveStatus status = state_ != DeviceState::Ready ? MoveStatus::NotReady
                            : halt_due_                  ? MoveStatus::Busy
                                                         : part(axis).ask(target_rad, speed_radps);
  counters_.count(PtuEvent::MovesRefused, status == MoveStatus::Accepted ? 0 : 1);
  return status;
}

MoveStatus PtuDriver::halt() noexcept {
  if (state_ != DeviceState::Ready) {
    counters_.count(PtuEvent::MovesRefused);
    return MoveStatus::NotReady;
  }
  halt_due_ = true;
  return MoveStatus::Accepted;
}

/// Brings the link up and starts over when it is new.
bool PtuDriver::link_ready(Stamp now) noexcept {
  link_.service(now);
  if (!link_.is_up()) {
    if (state_ != DeviceState::Absent) {
      forget();
      state_ = DeviceState::Absent;
    }
    return false;
  }
  if (state_ == DeviceState::Absent || link_.epoch() != epoch_) {
    epoch_ = link_.epoch();
    startup_.renew();
    exchange_.health().forget();
    echo_tries_ = 0;
    feedback_tries_ = 0;
    compose_remark();
    restart(now);
  }
  return true;
}

void PtuDriver::forget() noexcept {
  const auto is_home = [](const AxisStatus& axis) { return !axis.moving && axis.position_rad == 0.0; };
  if (state_ == DeviceState::Ready && !(is_home(pan_.status()) && is_home(tilt_.status()))) {
    startup_.note_away();
  }
  pan_.forget();
  tilt_.forget();
  pending_.reset();
  job_ = Job::None;
  refused_polls_ = 0;
  halt_due_ = false;
  echo_due_ = false;
  feedback_due_ = false;
}

void PtuDriver::restart(Stamp now, std::string_view why) noexcept {
  lost_because_ = why;
  counters_.count(PtuEvent::Restarts, begun_ ? 1 : 0);
  begun_ = true;
  forget();
  state_ = DeviceState::Starting;
  startup_.begin(now);
}

void PtuDriver::step_starting(Stamp now, const PtuExchange::Notices& notices) noexcept {
  switch (startup_.step(now, notices)) {
    case PtuStartup::Progress::Running:
      state_ = DeviceState::Starting;
      break;
    case PtuStartup::Progress::Faulted:
      state_ = DeviceState::Faulted;
      break;
    case PtuStartup::Progress::Done:
      get_ready(now);
      break;
  }
}

void PtuDriver::get_ready(Stamp now) noexcept {
  pan_.set_up(startup_.facts(Axis::Pan), startup_.position(Axis::Pan), now);
  tilt_.set_up(startup_.facts(Axis::Tilt), startup_.position(Axis::Tilt), now);
  info_.model = FixedText<80>(exchange_.version());
  info_.pan = pan_.info();
  info_.tilt = tilt_.info();
  disturbances_ = exchange_.disturbances();
  state_ = DeviceState::Ready;
}

void PtuDriver::step_ready(Stamp now, const PtuExchange::Notices& notices) noexcept {
  if (notices.banner) {
    restart(now, kStartedAnew);
    startup_.begin_powered(now);
    return;
  }
  heed_manner(notices);
  heed_disturbance(now);
  if (const std::optional<PtuAnswer> answer = exchange_.take_answer()) {
    on_answer(*answer, now);
  }
  if (exchange_.lost()) {
    restart(now, kNoAnswers);
  }
  if (state_ != DeviceState::Ready) {
    return;
  }
  const bool free = exchange_.ready(now) && due_job(now) != Job::None;
  if (pending_ && (free || now >= pending_->since + config_.drain)) {
    believe_pending(now);
  }
  if (free && state_ == DeviceState::Ready) {
    send_job(due_job(now), now);
  }
}

/// Some units, and adapters that hear what they send, cannot be made silent or terse.
void PtuDriver::heed_manner(const PtuExchange::Notices& notices) noexcept {
  if ((notices.plain && echo_tries_ > 0) || (notices.terse && feedback_tries_ > 0)) {
    echo_tries_ = notices.plain ? 0 : echo_tries_;
    feedback_tries_ = notices.terse ? 0 : feedback_tries_;
    compose_remark();
  }
  echo_due_ = echo_due_ || (notices.echo && echo_tries_ < kSettingTries);
  feedback_due_ = feedback_due_ || (notices.verbose && feedback_tries_ < kSettingTries);
}

/// What was taken last may be the very reply that was one too many, and the unit may have lost its settings.
void PtuDriver::heed_disturbance(Stamp now) noexcept {
  if (exchange_.disturbances() == disturbances_) {
    return;
  }
  disturbances_ = exchange_.disturbances();
  pan_.forget_speed();
  tilt_.forget_speed();
  if (pending_) {
    counters_.count(PtuEvent::PositionsRevoked);
    part(pending_->axis).poll_again(now);
    pending_.reset();
  }
}

void PtuDriver::on_answer(const PtuAnswer& answer, Stamp now) noexcept {
  const Job job = std::exchange(job_, Job::None);
  const bool settled = answer.outcome != PtuOutcome::Failed;
  switch (job) {
    case Job::None:
      break;
    case Job::Halt:
      if (settled) {
        halt_due_ = false;
        pan_.on_halted(now);
        tilt_.on_halted(now);
      }
      break;
    case Job::Echo:
      echo_due_ = !settled;
      echo_tries_ += settled ? 1 : 0;
      compose_remark();
      counters_.count(PtuEvent::SettingsRestored, settled ? 1 : 0);
      pan_.forget_speed();
      tilt_.forget_speed();
      break;
    case Job::Feedback:
      feedback_due_ = !settled;
      feedback_tries_ += settled ? 1 : 0;
      compose_remark();
      counters_.count(PtuEvent::SettingsRestored, settled ? 1 : 0);
      break;
    case Job::Move:
      part(answer.command.axis()).on_moved(answer, now);
      if (answer.axis_error) {
        startup_.want_reset();
        restart(now, kAxisError);
      }
      break;
    case Job::Poll:
      on_position(answer, now);
      break;
  }
}

void PtuDriver::on_position(const PtuAnswer& answer, Stamp now) noexcept {
  const Axis axis = answer.command.axis();
  refused_polls_ = answer.outcome == PtuOutcome::Refused ? refused_polls_ + 1 : 0;
  if (refused_polls_ >= kRefusedPollsMax) {
    restart(now, kRefusesPolls);
    return;
  }
  if (answer.outcome != PtuOutcome::Done) {
    part(axis).poll_again(now);
    return;
  }
  const Stamp half = (answer.begun - answer.sent) / 2;
  pending_ = Pending{{answer.sent + half, half, static_cast<std::int32_t>(answer.value)}, axis, now};
}

void PtuDriver::believe_pending(Stamp now) noexcept {
  const Pending pending = *pending_;
  pending_.reset();
  if (!part(pending.axis).on_sighting(pending.sighting, now)) {
    restart(now, kStrangePosition);
  }
  const std::array ramps{pan_.ramp(), tilt_.ramp()};
  const std::uint64_t learnt = counters_[PtuEvent::ProfilesLearnt];
  if (state_ == DeviceState::Ready && (ramps != ramps_ || learnt != learnt_)) {
    ramps_ = ramps;
    learnt_ = learnt;
    info_.pan = pan_.info();
    info_.tilt = tilt_.info();
    compose_remark();
  }
}

Axis PtuDriver::next_poll() const noexcept {
  return tilt_.due() < pan_.due() ? Axis::Tilt : Axis::Pan;
}

PtuDriver::Job PtuDriver::due_job(Stamp now) const noexcept {
  if (halt_due_) {
    return Job::Halt;
  }
  if (echo_due_) {
    return Job::Echo;
  }
  if (feedback_due_) {
    return Job::Feedback;
  }
  if (pan_.next_command() || tilt_.next_command()) {
    return Job::Move;
  }
  return part(next_poll()).due() <= now ? Job::Poll : Job::None;
}

void PtuDriver::send_job(Job job, Stamp now) noexcept {
  PtuCommand command("H", PtuExpect::Setting);
  Stamp timeout = config_.motion_timeout;
  switch (job) {
    case Job::None:
      return;
    case Job::Halt:
      pan_.drop_request();
      tilt_.drop_request();
      break;
    case Job::Echo:
    case Job::Feedback:
      command = PtuCommand(job == Job::Echo ? "ED" : "FT", PtuExpect::Setting);
      timeout = config_.mode_timeout;
      break;
    case Job::Move:
      command = pan_.next_command() ? *pan_.next_command() : tilt_.next_command().value_or(command);
      break;
    case Job::Poll:
      command = PtuCommand::query(next_poll(), PtuQuantity::Position);
      timeout = config_.query_timeout;
      break;
  }
  if (!exchange_.send(command, timeout, now)) {
    return;
  }
  job_ = job;
  if (job == Job::Poll) {
    part(command.axis()).on_poll_sent(now);
  }
}

/// Tells the trouble of the line anew when it is another one or much greater.
void PtuDriver::judge_line() noexcept {
  using Trouble = PtuLineHealth::Trouble;
  const PtuLineHealth& health = exchange_.health();
  const double late_s = to_seconds(health.lateness());
  const double told_s = to_seconds(told_lateness_);
  const bool is_later =
      health.trouble() == Trouble::Late && std::abs(late_s - told_s) > kLatenessTold * told_s;
  const bool is_noisier =
      health.trouble() == Trouble::Noise && health.noise_bytes() > kNoiseTold * told_noise_;
  if (health.trouble() == trouble_ && !is_later && !is_noisier) {
    return;
  }
  trouble_ = health.trouble();
  told_lateness_ = health.lateness();
  told_noise_ = health.noise_bytes();
  TextWriter<kRemarkMax> text;
  switch (trouble_) {
    case Trouble::None:
      break;
    case Trouble::Late:
      text << "pan-tilt unit: replies come late (";
      text.tenths(late_s) << " s; ptu.query_timeout_s is ";
      text.tenths(to_seconds(config_.query_timeout)) << "); check its line and adapter, or raise that";
      break;
    case Trouble::Misfit:
      text
          << "pan-tilt unit: replies do not fit the questions (swapped, doubled or of another device); check "
             "its line and that nothing else commands it";
      break;
    case Trouble::Noise:
      text << "pan-tilt unit: line noise (bytes that are no replies: ";
      text.whole(static_cast<double>(told_noise_)) << "); check cable, shield and ground, and ptu.rates_baud";
      break;
  }
  trouble_text_ = text.text();
  compose_remark();
}

void PtuDriver::compose_remark() noexcept {
  if (trouble_ != PtuLineHealth::Trouble::None) {
    remark_ = trouble_text_;
  } else if (echo_tries_ >= kSettingTries) {
    remark_ = FixedText<kRemarkMax>(kEchoes);
  } else if (feedback_tries_ >= kSettingTries) {
    remark_ = FixedText<kRemarkMax>(kSentences);
  } else {
    remark_ = ramp_remark(pan_.ramp() != PtuRamp::AsTold ? Axis::Pan : Axis::Tilt);
  }
}

FixedText<kRemarkMax> PtuDriver::ramp_remark(Axis axis) const noexcept {
  const PtuRamp ramp = part(axis).ramp();
  if (ramp == PtuRamp::AsTold) {
    return {};
  }
  const auto figures = [axis](TextWriter<kRemarkMax>& text, double acceleration_ps2, double base_ps) {
    text << (axis == Axis::Pan ? " (PA " : " (TA ");
    text.whole(acceleration_ps2) << (axis == Axis::Pan ? ", PB " : ", TB ");
    text.whole(base_ps) << ")";
  };
  const PtuAxisFacts& told = part(axis).told();
  TextWriter<kRemarkMax> text;
  text << (axis == Axis::Pan ? "pan" : "tilt") << " positions do not follow the acceleration that it tells";
  figures(text, told.acceleration_ps2, told.base_speed_ps);
  if (ramp == PtuRamp::Learnt) {
    const AxisDynamics& used = part(axis).info().dynamics;
    text << "; what they show is used";
    figures(text, used.acceleration_radps2 / told.position_rad, used.base_speed_radps / told.position_rad);
  } else {
    text << ", nor any other; check its load, its supply and these settings";
  }
  return text.text();
}

}  // namespace slamsensor::hal
