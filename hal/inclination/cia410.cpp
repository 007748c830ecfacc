#include "hal/inclination/cia410.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace slamsensor::hal {
namespace {

// Objects of CiA 410.
constexpr SdoAddress kResolution{0x6000, 0};  // thousandths of a degree
constexpr SdoAddress kLong16{0x6010, 0};
constexpr SdoAddress kLateral16{0x6020, 0};
constexpr SdoAddress kLong32{0x6110, 0};
constexpr SdoAddress kLateral32{0x6120, 0};

constexpr std::uint32_t kProfile = 410;  // lower 16 bits of the device type
constexpr std::size_t kFramesPerStep = 64;
constexpr std::size_t kEmergencyBytes = 8;
constexpr std::size_t kEventsUsed = static_cast<std::size_t>(CanopenEvent::Restarts) + 1;
constexpr double kMilliDegree = 0.001 * std::numbers::pi / 180.0;
constexpr double kSlopeMax_rad = 0.5 * std::numbers::pi;
constexpr double kUpMin = 0.017;  // least z of the upward direction: 1 deg above lying on a side

constexpr Stamp kRetry = std::chrono::milliseconds(500);
constexpr Stamp kBootWait = std::chrono::milliseconds(100);

constexpr std::string_view kNoAnswer = "it does not answer";
constexpr std::string_view kCheckBus =
    "check its power, node number, bit rate and the termination of the bus";

bool is_resolution(std::uint32_t value) noexcept {
  return value == 1 || value == 10 || value == 100 || value == 1000;
}

}  // namespace

tl::expected<std::unique_ptr<Cia410Inclinometer>, InitError> Cia410Inclinometer::create(
    const Cia410Config& config, CanLink& link) {
  if (config.node < 1 || config.node > kNodeMax) {
    return tl::unexpected(InitError{"node is " + std::to_string(config.node) + "; 1 to 127 is allowed"});
  }
  if (!(config.poll_hz >= 0.1 && config.poll_hz <= 50.0)) {
    return tl::unexpected(
        InitError{"poll_hz is " + std::to_string(config.poll_hz) + "; 0.1 to 50 is allowed"});
  }
  return std::unique_ptr<Cia410Inclinometer>(new Cia410Inclinometer(config, link));
}

Cia410Inclinometer::Cia410Inclinometer(const Cia410Config& config, CanLink& link)
    : config_(config),
      title_("node " + std::to_string(config.node) + " on " + config.interface),
      link_(link),
      sdo_(config_.node, sdo_config_, link, counters_) {
  problem_ = describe("CAN inclinometer", title_, {kNoAnswer, 0, kCheckBus});
}

std::string_view Cia410Inclinometer::problem() const noexcept {
  if (state_ == DeviceState::Ready) {
    return {};
  }
  return state_ == DeviceState::Absent && !link_.problem().empty() ? link_.problem() : problem_.view();
}

std::span<const Counter> Cia410Inclinometer::counters() const noexcept {
  return counters_.all().first(kEventsUsed);
}

std::optional<Inclination> Cia410Inclinometer::take() noexcept {
  return std::exchange(measured_, std::nullopt);
}

void Cia410Inclinometer::step(Stamp now) noexcept {
  if (!link_ready(now)) {
    return;
  }
  receive(now);
  sdo_.step(now);
  if (const auto result = sdo_.take()) {
    on_result(*result, now);
  }
  if (sdo_.is_idle() && now >= next_) {
    ask(now);
  }
}

bool Cia410Inclinometer::link_ready(Stamp now) noexcept {
  link_.service(now);
  if (!link_.is_up()) {
    if (state_ != DeviceState::Absent) {
      fail(DeviceState::Absent, "the CAN bus is down", "check the interface, its cable and its termination",
           now);
    }
    return false;
  }
  if (epoch_ != link_.epoch() || state_ == DeviceState::Absent) {
    epoch_ = link_.epoch();
    state_ = DeviceState::Starting;
    problem_ = describe("CAN inclinometer", title_, {kNoAnswer, 0, kCheckBus});
    begin(now);
  }
  return true;
}

void Cia410Inclinometer::receive(Stamp now) noexcept {
  for (std::size_t i = 0; i < kFramesPerStep; ++i) {
    const CanRead got = link_.receive();
    if (got.status != LinkStatus::Ok) {
      return;
    }
    if (got.frame.extended) {
      continue;
    }
    if (got.frame.id == cob::kSdoReply + config_.node) {
      sdo_.on_frame(got, now);
    } else if (got.frame.id == cob::kHeartbeat + config_.node) {
      on_heartbeat(got.frame, now);
    } else if (got.frame.id == cob::kEmergency + config_.node) {
      on_emergency(got.frame, now);
    }
  }
}

void Cia410Inclinometer::on_heartbeat(const CanFrame& frame, Stamp now) noexcept {
  if (frame.bytes().size() != 1) {
    counters_.count(CanopenEvent::FramesMalformed);
  } else if ((frame.data[0] & 0x7FU) == static_cast<std::uint8_t>(NmtState::BootUp)) {
    // What it was set to may be another now.
    counters_.count(CanopenEvent::BootUps);
    if (state_ == DeviceState::Ready) {
      fail(DeviceState::Starting, "it started anew by itself", "check its power", now);
    }
    begin(now + kBootWait);
  }
}

void Cia410Inclinometer::on_emergency(const CanFrame& frame, Stamp now) noexcept {
  if (frame.bytes().size() != kEmergencyBytes) {
    counters_.count(CanopenEvent::FramesMalformed);
  } else if (le_number(frame, 0, 2) != 0 && frame.data[2] != 0) {
    counters_.count(CanopenEvent::Emergencies);
    fail(DeviceState::Faulted, "it reports an error (EMCY)",
         "its manual names the code; it may lean beyond its range", now);
  }
}

void Cia410Inclinometer::begin(Stamp at) noexcept {
  sdo_.reset();
  measured_.reset();
  step_ = Step::DeviceType;
  width_ = Width::Bits32;
  next_ = at;
}

void Cia410Inclinometer::ask(Stamp now) noexcept {
  if (step_ == Step::Long && state_ == DeviceState::Ready) {
    next_ = std::max(next_ + from_seconds(1.0 / config_.poll_hz), now);
  }
  sdo_.begin(request(), now);
}

SdoRequest Cia410Inclinometer::request() const noexcept {
  switch (step_) {
    case Step::DeviceType:
      return SdoRequest::read(object::kDeviceType);
    case Step::Name:
      return {SdoRequest::Kind::ReadText, object::kDeviceName};
    case Step::Resolution:
      return SdoRequest::read(kResolution);
    case Step::Long:
      return SdoRequest::read(width_ == Width::Bits32 ? kLong32 : kLong16);
    case Step::Lateral:
      break;
  }
  return SdoRequest::read(width_ == Width::Bits32 ? kLateral32 : kLateral16);
}

void Cia410Inclinometer::on_result(const SdoResult& result, Stamp now) noexcept {
  if (result.outcome == SdoOutcome::TimedOut) {
    fail(DeviceState::Starting, kNoAnswer, kCheckBus, now);
    return;
  }
  switch (step_) {
    case Step::DeviceType:
      return on_type(result, now);
    case Step::Name:
      model_ = result.outcome == SdoOutcome::Done ? FixedText<80>(sdo_.text().view()) : FixedText<80>();
      step_ = Step::Resolution;
      return;
    case Step::Resolution:
      return on_resolution(result, now);
    case Step::Long:
      return on_long(result, now);
    case Step::Lateral:
      return on_lateral(result, now);
  }
}

void Cia410Inclinometer::on_type(const SdoResult& result, Stamp now) noexcept {
  if (result.outcome != SdoOutcome::Done || (result.value & 0xFFFFU) != kProfile) {
    fail(DeviceState::Faulted, "it is no CiA 410 inclinometer", "check inclination.can_node", now);
    return;
  }
  step_ = Step::Name;
}

void Cia410Inclinometer::on_resolution(const SdoResult& result, Stamp now) noexcept {
  if (result.outcome != SdoOutcome::Done || !is_resolution(result.value)) {
    fail(DeviceState::Faulted, "its resolution (6000h) is none of 1, 10, 100 and 1000",
         "set it with its maker's tool", now);
    return;
  }
  unit_rad_ = kMilliDegree * static_cast<double>(result.value);
  static_cast<void>(link_.send(nmt_frame(NmtCommand::Start, config_.node)));
  step_ = Step::Long;
}

void Cia410Inclinometer::on_long(const SdoResult& result, Stamp now) noexcept {
  if (result.outcome == SdoOutcome::Done) {
    long_rad_ = unit_rad_ * result.signed_value();
    long_sent_ = result.sent;
    step_ = Step::Lateral;
  } else if (width_ == Width::Bits32 && state_ != DeviceState::Ready) {
    width_ = Width::Bits16;
    counters_.count(CanopenEvent::Restarts);
  } else {
    fail(DeviceState::Faulted, "it refuses to report its longitudinal slope", "its manual says why", now);
  }
}

void Cia410Inclinometer::on_lateral(const SdoResult& result, Stamp now) noexcept {
  if (result.outcome == SdoOutcome::Done) {
    measure(result, now);
  } else {
    fail(DeviceState::Faulted, "it reports no lateral slope", "take an inclinometer of two axes", now);
  }
}

void Cia410Inclinometer::measure(const SdoResult& lateral, Stamp now) noexcept {
  const double lateral_rad = unit_rad_ * lateral.signed_value();
  const double x = (config_.long_slope == LongSlope::FrontUp ? 1.0 : -1.0) * std::sin(long_rad_);
  const double y = (config_.lateral_slope == LateralSlope::LeftUp ? 1.0 : -1.0) * std::sin(lateral_rad);
  const double z_squared = 1.0 - x * x - y * y;
  if (std::abs(long_rad_) > kSlopeMax_rad || std::abs(lateral_rad) > kSlopeMax_rad ||
      z_squared < kUpMin * kUpMin) {
    counters_.count(CanopenEvent::FramesMalformed);
    fail(DeviceState::Faulted, "it reports slopes that cannot be",
         "it leans beyond its range, or is mounted on a side", now);
    return;
  }
  state_ = DeviceState::Ready;
  problem_ = {};
  step_ = Step::Long;
  measured_ = inclination_of_up(long_sent_ + (lateral.received - long_sent_) / 2, x, y, std::sqrt(z_squared));
}

void Cia410Inclinometer::fail(DeviceState state, std::string_view what, std::string_view advice,
                              Stamp now) noexcept {
  state_ = state;
  problem_ = describe("CAN inclinometer", title_, {what, 0, advice});
  begin(now + kRetry);
}

}  // namespace slamsensor::hal
