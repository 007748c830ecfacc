#include "hal/pantilt/canopen/canopen_pdo.hpp"

namespace slamsensor::hal {
namespace {

constexpr std::uint32_t kInvalidBit = 1U << 31;
constexpr std::uint32_t kNoRtrBit = 1U << 30;
constexpr std::uint32_t kIdMask = 0x7FF;
constexpr std::uint8_t kTypeEverySync = 1;
constexpr std::uint8_t kTypeLastSync = 240;
constexpr std::uint8_t kTypeEvent = 255;
constexpr std::uint8_t kPdos = 4;  // with predefined identifiers
constexpr std::uint8_t kEntriesMax = 8;
constexpr std::uint32_t kPdoBits = 64;

constexpr std::uint32_t map_entry(SdoAddress address, std::uint32_t bits) noexcept {
  return static_cast<std::uint32_t>(address.index) << 16U | static_cast<std::uint32_t>(address.sub) << 8U |
         bits;
}

}  // namespace

void CanopenPdoScript::begin(Stamp) noexcept {
  map_ = {};
  found_ = {};
  pdo_ = 0;
  told_ = 0;
  is_own_ = config_.feedback != CanopenFeedback::DefaultPdo;
  step_ = is_own_ ? Step::Cob : Step::Count;
  if (config_.feedback == CanopenFeedback::Sdo) {
    step_ = Step::Done;
  }
}

std::optional<SdoRequest> CanopenPdoScript::next() const noexcept {
  switch (step_) {
    case Step::Cob:
      return SdoRequest::read(setting(1));
    case Step::Disable:
      return SdoRequest::write(setting(1), enabled_cob() | kInvalidBit, 4);
    case Step::Clear:
      return SdoRequest::write(mapping(0), 0, 1);
    case Step::Word:
      return SdoRequest::write(mapping(1), entry_of(Step::Word), 4);
    case Step::Value:
      return SdoRequest::write(mapping(2), entry_of(Step::Value), 4);
    case Step::Close:
      return SdoRequest::write(mapping(0), 2, 1);
    case Step::Type:
      return SdoRequest::write(setting(2), wanted_type(), 1);
    case Step::TypeTold:
      return SdoRequest::read(setting(2));
    case Step::Timer:
      return SdoRequest::write(setting(5), static_cast<std::uint32_t>(1000.0 / config_.poll_hz), 2);
    case Step::Enable:
      return SdoRequest::write(setting(1), enabled_cob(), 4);
    case Step::Count:
      return SdoRequest::read(mapping(0));
    case Step::Entry:
      return SdoRequest::read(mapping(found_.entry));
    case Step::Done:
      break;
  }
  return std::nullopt;
}

CanopenProblem CanopenPdoScript::on_result(const SdoResult& result, const SdoClient&, Stamp) noexcept {
  if (step_ == Step::Count || step_ == Step::Entry) {
    return on_search(result);
  }
  const bool optional = step_ == Step::Type || step_ == Step::TypeTold || step_ == Step::Timer;
  // A found PDO whose identifier cannot be changed serves as it is, when it is on.
  const bool stands = !is_own_ && step_ != Step::Cob && (told_ & kInvalidBit) == 0;
  if (result.outcome == SdoOutcome::Aborted && !optional && !stands) {
    return is_own_ ? map_fixed(result.value) : look_at_next();
  }
  on_setting(result);
  return CanopenProblem::None;
}

void CanopenPdoScript::on_setting(const SdoResult& result) noexcept {
  const bool done = result.outcome == SdoOutcome::Done;
  counters_.count(CanopenEvent::SettingsRefused, done ? 0 : 1);
  switch (step_) {
    case Step::Cob:
      told_ = result.value;
      step_ = Step::Disable;
      break;
    case Step::Disable:
      step_ = is_own_ ? Step::Clear : Step::Type;
      break;
    case Step::Clear:
      step_ = Step::Word;
      break;
    case Step::Word:
      step_ = Step::Value;
      break;
    case Step::Value:
      step_ = Step::Close;
      break;
    case Step::Close:
      step_ = Step::Type;
      break;
    case Step::Type:
      step_ = Step::TypeTold;
      if (done) {
        use_type(wanted_type());
      }
      break;
    case Step::TypeTold:
      use_type(done ? result.value : kTypeEvent);
      break;
    case Step::Timer:
      step_ = Step::Enable;
      break;
    case Step::Enable:
      map_.is_present = true;
      map_.cob_id = enabled_cob() & kIdMask;
      map_.size = is_own_ ? 6 : static_cast<std::uint8_t>(found_.bits / 8);
      map_.word_at = is_own_ ? 0 : static_cast<std::uint8_t>(*found_.word_bit / 8);
      map_.value_at = is_own_ ? 2 : static_cast<std::uint8_t>(*found_.value_bit / 8);
      step_ = Step::Done;
      break;
    case Step::Count:
    case Step::Entry:
    case Step::Done:
      break;
  }
}

void CanopenPdoScript::use_type(std::uint32_t type) noexcept {
  map_.is_sync = type <= kTypeLastSync;
  step_ = !map_.is_sync && direction_ == PdoDirection::Transmit ? Step::Timer : Step::Enable;
}

CanopenProblem CanopenPdoScript::map_fixed(std::uint32_t code) noexcept {
  counters_.count(CanopenEvent::MappingsFixed);
  if (config_.feedback == CanopenFeedback::MappedPdo) {
    return abort_problem(code);
  }
  is_own_ = false;
  pdo_ = 0;
  step_ = Step::Count;
  return CanopenProblem::None;
}

CanopenProblem CanopenPdoScript::on_search(const SdoResult& result) noexcept {
  if (result.outcome == SdoOutcome::Aborted) {
    return look_at_next();
  }
  if (step_ == Step::Count) {
    if (result.value == 0 || result.value > kEntriesMax) {
      return look_at_next();
    }
    found_ = {};
    found_.count = static_cast<std::uint8_t>(result.value);
    found_.entry = 1;
    step_ = Step::Entry;
    return CanopenProblem::None;
  }
  if (result.value == entry_of(Step::Word)) {
    found_.word_bit = found_.bits;
  }
  if (result.value == entry_of(Step::Value)) {
    found_.value_bit = found_.bits;
  }
  found_.bits += result.value & 0xFFU;
  if (found_.entry < found_.count) {
    ++found_.entry;
    return CanopenProblem::None;
  }
  if (!is_found()) {
    return look_at_next();
  }
  step_ = Step::Cob;
  return CanopenProblem::None;
}

/// Whether both objects lie in the PDO, on whole bytes. One to be sent must have nothing else: its other
/// objects would be overwritten.
bool CanopenPdoScript::is_found() const noexcept {
  return found_.word_bit && found_.value_bit && *found_.word_bit % 8 == 0 && *found_.value_bit % 8 == 0 &&
         found_.bits % 8 == 0 && found_.bits <= kPdoBits &&
         (direction_ == PdoDirection::Transmit || found_.count == 2);
}

CanopenProblem CanopenPdoScript::look_at_next() noexcept {
  if (++pdo_ < kPdos) {
    step_ = Step::Count;
    return CanopenProblem::None;
  }
  step_ = Step::Done;
  // Without one to receive, the node is commanded by SDO.
  const bool needed = config_.feedback == CanopenFeedback::DefaultPdo && direction_ == PdoDirection::Transmit;
  return needed ? CanopenProblem::NoPdo : CanopenProblem::None;
}

SdoAddress CanopenPdoScript::setting(std::uint8_t sub) const noexcept {
  const int base = direction_ == PdoDirection::Receive ? 0x1400 : 0x1800;
  return {static_cast<std::uint16_t>(base + pdo_), sub};
}

SdoAddress CanopenPdoScript::mapping(std::uint8_t sub) const noexcept {
  const int base = direction_ == PdoDirection::Receive ? 0x1600 : 0x1A00;
  return {static_cast<std::uint16_t>(base + pdo_), sub};
}

std::uint32_t CanopenPdoScript::entry_of(Step step) const noexcept {
  const bool receive = direction_ == PdoDirection::Receive;
  return step == Step::Word ? map_entry(receive ? object::kControlword : object::kStatusword, 16)
                            : map_entry(receive ? object::kTarget : object::kPosition, 32);
}

/// The identifier to use, valid, with the "no RTR" bit as the node had it.
std::uint32_t CanopenPdoScript::enabled_cob() const noexcept {
  const std::uint32_t base = direction_ == PdoDirection::Receive ? cob::kReceivePdo : cob::kTransmitPdo;
  const std::uint32_t predefined = base + 0x100U * pdo_ + node_;
  const std::uint32_t had = told_ & kIdMask;
  return (told_ & kNoRtrBit) | (is_own_ || had == 0 ? predefined : had);
}

std::uint8_t CanopenPdoScript::wanted_type() const noexcept {
  return config_.pdo_timing == CanopenPdoTiming::Sync ? kTypeEverySync : kTypeEvent;
}

}  // namespace slamsensor::hal
