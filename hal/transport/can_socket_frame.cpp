#include "hal/transport/can_socket_frame.hpp"

#include <algorithm>
#include <linux/can/error.h>

namespace slamsensor::hal {
namespace {

constexpr Stamp kAgeMax = std::chrono::seconds(2);

constexpr std::array<std::string_view, kCanEvents> kNames = {
    "opened",         "open_failed", "interface_lost", "io_errors",     "bus_off",      "restarted",
    "rx_overflow",    "tx_overflow", "error_warning",  "error_passive", "error_active", "no_ack",
    "tx_timeout",     "bus_errors",  "remote_ignored", "fd_ignored",    "bad_frames",   "stamps_refused",
    "frames_dropped", "queue_full",  "send_refused"};

struct ErrorBit {
  std::uint32_t bit;
  CanEvent event;
};

constexpr std::array<ErrorBit, 7> kClasses = {{{CAN_ERR_TX_TIMEOUT, CanEvent::TxTimeout},
                                               {CAN_ERR_ACK, CanEvent::NoAck},
                                               {CAN_ERR_PROT, CanEvent::BusError},
                                               {CAN_ERR_TRX, CanEvent::BusError},
                                               {CAN_ERR_BUSERROR, CanEvent::BusError},
                                               {CAN_ERR_BUSOFF, CanEvent::BusOff},
                                               {CAN_ERR_RESTARTED, CanEvent::Restarted}}};

constexpr std::array<ErrorBit, 5> kController = {
    {{CAN_ERR_CRTL_RX_OVERFLOW, CanEvent::RxOverflow},
     {CAN_ERR_CRTL_TX_OVERFLOW, CanEvent::TxOverflow},
     {CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING, CanEvent::ErrorWarning},
     {CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE, CanEvent::ErrorPassive},
     {CAN_ERR_CRTL_ACTIVE, CanEvent::ErrorActive}}};

void count_bits(std::span<const ErrorBit> table, std::uint32_t bits, CanCounters& counters) noexcept {
  for (const ErrorBit& entry : table) {
    if ((bits & entry.bit) != 0) {
      counters.count(entry.event);
    }
  }
}

}  // namespace

const std::array<std::string_view, kCanEvents>& can_event_names() noexcept {
  return kNames;
}

std::optional<CanFrame> to_data_frame(const canfd_frame& raw, std::size_t bytes,
                                      CanCounters& counters) noexcept {
  if (bytes == CANFD_MTU) {
    counters.count(CanEvent::FdIgnored);
    return std::nullopt;
  }
  if (bytes != CAN_MTU || raw.len > CAN_MAX_DLEN) {
    counters.count(CanEvent::BadFrame);
    return std::nullopt;
  }
  if ((raw.can_id & CAN_RTR_FLAG) != 0) {
    counters.count(CanEvent::RemoteIgnored);
    return std::nullopt;
  }
  CanFrame frame;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = raw.len;
  std::copy_n(raw.data, frame.size, frame.data.begin());
  return frame;
}

bool is_error_frame(const canfd_frame& raw, std::size_t bytes) noexcept {
  return bytes == CAN_MTU && (raw.can_id & CAN_ERR_FLAG) != 0;
}

BusState take_error_frame(const canfd_frame& raw, CanCounters& counters) noexcept {
  count_bits(kClasses, raw.can_id, counters);
  if ((raw.can_id & CAN_ERR_CRTL) != 0) {
    count_bits(kController, raw.data[1], counters);
  }
  return (raw.can_id & (CAN_ERR_BUSOFF | CAN_ERR_RESTARTED)) != 0 ? BusState::Off : BusState::On;
}

std::optional<can_frame> to_raw(const CanFrame& frame) noexcept {
  if (frame.size > CAN_MAX_DLEN || frame.id > (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK)) {
    return std::nullopt;
  }
  can_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
  raw.len = frame.size;
  std::copy_n(frame.data.begin(), frame.size, raw.data);
  return raw;
}

std::optional<Stamp> monotonic_stamp(Stamp arrived, Stamp realtime_ahead, Stamp now) noexcept {
  const Stamp stamp = arrived - realtime_ahead;
  if (stamp > now || now - stamp > kAgeMax) {
    return std::nullopt;
  }
  return stamp;
}

}  // namespace slamsensor::hal
