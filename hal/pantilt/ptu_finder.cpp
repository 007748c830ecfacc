#include "hal/pantilt/ptu_finder.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace slamsensor::hal {
namespace {

constexpr std::uint32_t kNetworkBaud = 9600;  // units with an identity keep to it (PTU-D46 manual)

std::size_t index_of(const std::vector<std::uint32_t>& rates, std::uint32_t rate) noexcept {
  return static_cast<std::size_t>(std::find(rates.begin(), rates.end(), rate) - rates.begin());
}

}  // namespace

PtuRates::PtuRates(const PtuConfig& config) : rates_(config.rates_baud), fast_wanted_(config.fast_baud != 0) {
  fast_index_ = index_of(rates_, config.fast_baud);
  if (fast_wanted_ && fast_index_ == rates_.size()) {
    rates_.push_back(config.fast_baud);
  }
}

PtuRates::Step PtuRates::advance() noexcept {
  if (on_trial_) {
    on_trial_ = false;
    fast_refused_ = true;
    index_ = before_trial_;
    return Step::TrialFailed;
  }
  index_ = (index_ + 1) % rates_.size();
  ++tried_;
  return tried_ % rates_.size() == 0 ? Step::WentRound : Step::Next;
}

bool PtuRates::wants_fast() const noexcept {
  return fast_wanted_ && !fast_refused_ && !on_trial_ && index_ != fast_index_;
}

void PtuRates::try_fast() noexcept {
  before_trial_ = index_;
  index_ = fast_index_;
  on_trial_ = true;
}

void PtuRates::confirm() noexcept {
  tried_ = 0;
  on_trial_ = false;
}

void PtuRates::go_to_network_rate() noexcept {
  const std::size_t index = index_of(rates_, kNetworkBaud);
  index_ = index < rates_.size() ? index : index_;
}

namespace {

constexpr std::string_view kLooking = "looking for the pan-tilt unit on its serial line";
constexpr std::string_view kSilent =
    "pan-tilt unit: no reply at any of the configured line rates; check its power, the cable and the rates";
constexpr std::string_view kRefuses =
    "pan-tilt unit: it answers, but refuses the commands ED, FT and V that every unit of this kind knows; "
    "check "
    "that this port leads to the unit itself, and its firmware";
constexpr std::string_view kBusy = "pan-tilt unit: it is resetting or moving; waiting until it rests";

/// Ends a monitor scan and half a command, whatever the firmware ends commands with.
constexpr std::string_view kWakeText = "  \r";
/// Makes every unit on the line listen, gives it identity 0, saves, resets (leading spaces needed).
constexpr std::string_view kRecoveryText = "   _0 u0 DS R ";

constexpr std::uint32_t kAttemptsPerRate = 2;
constexpr std::uint32_t kAttemptsReplied = 8;  // where the unit has spoken
constexpr std::uint32_t kResetSigns = 2;       // limit reports: a few bytes of noise may look like one
constexpr Stamp kRatePause = std::chrono::milliseconds(20);
constexpr Stamp kBabbleMax = std::chrono::seconds(2);

}  // namespace

PtuFinder::PtuFinder(ByteLink& link, const PtuConfig& config, PtuCounters& counters, PtuExchange& exchange)
    : link_(link),
      config_(config),
      counters_(counters),
      exchange_(exchange),
      rates_(config),
      problem_(kLooking) {
}

void PtuFinder::begin(Stamp now) noexcept {
  signs_ = 0;
  attempts_ = 0;
  replied_ = false;
  refused_ = false;
  recovering_ = false;
  problem_ = kLooking;
  enter(Phase::Wake, now);
}

void PtuFinder::fail(Stamp now) noexcept {
  ++attempts_;
  const bool patient = resetting() && now < resetting_since_ + config_.reset_timeout;
  const std::uint32_t attempts_max = replied_ ? kAttemptsReplied : kAttemptsPerRate;
  if (patient || (!resetting() && attempts_ < attempts_max)) {
    problem_ = patient ? kBusy : problem_;
    enter(Phase::Wake, now);
    return;
  }
  give_up_rate(now);
}

void PtuFinder::await_reset(Stamp now) noexcept {
  signs_ = kResetSigns;
  resetting_since_ = now;
  problem_ = kBusy;
  enter(Phase::Wake, now);
}

void PtuFinder::heed(const PtuExchange::Notices& notices, Stamp now) noexcept {
  const bool was_resetting = resetting();
  signs_ = std::min(kResetSigns, signs_ + notices.marks);
  replied_ = replied_ || notices.replies > 0;
  if (resetting() && !was_resetting) {
    resetting_since_ = now;
  }
}

void PtuFinder::on_answer(const PtuAnswer& answer, Stamp now) noexcept {
  if (!is_asking()) {
    return;  // of a command from before the wake
  }
  if (phase_ == Phase::Rate) {
    on_rate(answer, now);
  } else if (answer.outcome != PtuOutcome::Done) {
    refused_ = refused_ || answer.outcome == PtuOutcome::Refused;
    fail(now);
  } else if (phase_ == Phase::Version) {
    on_version(now);
  } else {
    enter(phase_ == Phase::Echo ? Phase::Feedback : Phase::Version, now);
  }
}

void PtuFinder::step(Stamp now) noexcept {
  if (now < wait_until_) {
    return;
  }
  switch (phase_) {
    case Phase::Wake:
      wake(now);
      break;
    case Phase::Quiet:
      if (now >= exchange_.heard() + config_.drain || now >= wait_until_ + kBabbleMax) {
        enter(Phase::Echo, now);
      }
      break;
    case Phase::Found:
      break;
    default:
      ask(now);
      break;
  }
}

void PtuFinder::enter(Phase phase, Stamp now) noexcept {
  phase_ = phase;
  wait_until_ = now;
}

void PtuFinder::wake(Stamp now) noexcept {
  if (link_.baud() != rates_.current() && link_.set_baud(rates_.current()) != LinkStatus::Ok) {
    give_up_rate(now);
    return;
  }
  const std::string_view text = recovering_ ? kRecoveryText : kWakeText;
  std::array<std::uint8_t, kRecoveryText.size()> bytes{};
  std::transform(text.begin(), text.end(), bytes.begin(),
                 [](char c) { return static_cast<std::uint8_t>(c); });
  link_.discard_input();
  exchange_.reset(now);
  if (link_.write(std::span(bytes).first(text.size())) != LinkStatus::Ok) {
    return;
  }
  counters_.count(PtuEvent::NetworkRecoveries, recovering_ ? 1 : 0);
  recovering_ = false;
  enter(Phase::Quiet, now + config_.wake_wait);
}

void PtuFinder::ask(Stamp now) noexcept {
  if (!exchange_.ready(now)) {
    return;
  }
  if (phase_ == Phase::Rate) {
    exchange_.reset(now);  // nothing that comes from here to the next wake need have a meaning
  }
  PtuCommand command = PtuCommand("V", PtuExpect::Version);
  if (phase_ == Phase::Rate) {
    command = PtuCommand::baud(config_.fast_baud);
  } else if (phase_ != Phase::Version) {
    command = PtuCommand(phase_ == Phase::Echo ? "ED" : "FT", PtuExpect::Setting);
  }
  // A link that is full takes it at the next step.
  static_cast<void>(
      exchange_.send(command, phase_ == Phase::Rate ? config_.baud_wait : config_.mode_timeout, now));
}

/// The version is the marker of every later resynchronisation, so it must have been read twice alike.
void PtuFinder::on_version(Stamp now) noexcept {
  const bool same = version_.view() == exchange_.version();
  version_ = FixedText<kPtuLineMax>(exchange_.version());
  if (!same) {
    return;
  }
  rates_.confirm();
  exchange_.health().on_found();
  attempts_ = 0;
  signs_ = 0;
  replied_ = true;
  enter(rates_.wants_fast() ? Phase::Rate : Phase::Found, now);
}

/// Whether the unit confirms at the old or the new rate differs; only an error says that it stays.
void PtuFinder::on_rate(const PtuAnswer& answer, Stamp now) noexcept {
  if (answer.outcome == PtuOutcome::Refused) {
    rates_.refuse_fast();
    counters_.count(PtuEvent::BaudFallbacks);
  } else {
    rates_.try_fast();
    signs_ = 0;
    replied_ = false;
  }
  enter(Phase::Wake, std::max(now, answer.sent + config_.baud_wait));
}

void PtuFinder::give_up_rate(Stamp now) noexcept {
  signs_ = 0;
  attempts_ = 0;
  replied_ = false;
  switch (rates_.advance()) {
    case PtuRates::Step::TrialFailed:
      counters_.count(PtuEvent::BaudFallbacks);
      break;
    case PtuRates::Step::WentRound:
      problem_ = refused_ ? kRefuses : kSilent;
      refused_ = false;
      recover_network(now);
      break;
    case PtuRates::Step::Next:
      problem_ = problem_ == kSilent || problem_ == kRefuses ? problem_ : kLooking;
      break;
  }
  enter(Phase::Wake, now + kRatePause);
}

void PtuFinder::recover_network(Stamp now) noexcept {
  if (config_.network_recovery == PtuNetworkRecovery::Never || recovered_) {
    return;
  }
  rates_.go_to_network_rate();
  recovering_ = true;
  recovered_ = true;
  signs_ = kResetSigns;  // it resets after this, and cannot answer for a while
  resetting_since_ = now;
}

bool PtuFinder::resetting() const noexcept {
  return signs_ >= kResetSigns;
}

}  // namespace slamsensor::hal
