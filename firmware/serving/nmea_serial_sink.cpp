#include "firmware/serving/nmea_serial_sink.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr std::array<std::string_view, 6> kNames = {"nmea_serial_opened",       "nmea_serial_epochs",
                                                    "nmea_serial_bytes",        "nmea_serial_dropped_busy",
                                                    "nmea_serial_dropped_down", "nmea_serial_bytes_ignored"};

constexpr int kReadsMax = 16;  // a step ends although somebody writes to us without pause

}  // namespace

NmeaSerialSink::NmeaSerialSink(hal::ByteLink& link, hal::Stamp patience) noexcept
    : link_(link), patience_(patience), counters_(kNames) {
}

NmeaSerialSink::NmeaSerialSink(std::unique_ptr<hal::SerialPort> port, hal::Stamp patience) noexcept
    : port_(std::move(port)), link_(*port_), patience_(patience), counters_(kNames) {
}

tl::expected<std::unique_ptr<NmeaSerialSink>, hal::InitError> NmeaSerialSink::open(
    const NmeaSerialConfig& config, hal::Stamp patience) {
  hal::SerialConfig serial{.path = config.path};
  serial.line.baud = config.baud;
  auto port = hal::SerialPort::create(serial);
  if (!port) {
    return tl::unexpected(hal::InitError{"NMEA output: " + port.error().message});
  }
  return std::unique_ptr<NmeaSerialSink>(new NmeaSerialSink(std::move(*port), patience));
}

void NmeaSerialSink::step(hal::Stamp now) noexcept {
  link_.service(now);
  if (link_.epoch() != link_epoch_) {
    link_epoch_ = link_.epoch();
    line_free_ = now;
    counters_.count(NmeaSerialEvent::Opened);
  }
  std::array<std::uint8_t, 256> input{};
  for (int i = 0; i < kReadsMax; ++i) {
    const hal::ByteRead read = link_.read(input);
    if (read.status != hal::LinkStatus::Ok) {
      break;
    }
    counters_.count(NmeaSerialEvent::Ignored, read.count);
  }
}

void NmeaSerialSink::send(std::span<const char> epoch, const OutputTime& now) noexcept {
  line_free_ = std::max(line_free_, now.monotonic);
  if (link_.is_up() && line_free_ - now.monotonic > patience_) {
    counters_.count(NmeaSerialEvent::DroppedBusy);
    return;
  }
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(epoch.data()), epoch.size());
  switch (link_.write(bytes)) {
    case hal::LinkStatus::Ok:
      line_free_ += hal::line_time(epoch.size(), link_.baud());
      counters_.count(NmeaSerialEvent::Epochs);
      counters_.count(NmeaSerialEvent::Bytes, epoch.size());
      break;
    case hal::LinkStatus::Busy:
      counters_.count(NmeaSerialEvent::DroppedBusy);
      break;
    case hal::LinkStatus::Down:
      counters_.count(NmeaSerialEvent::DroppedDown);
      break;
  }
}

std::string_view NmeaSerialSink::problem() const noexcept {
  return port_ ? port_->problem() : std::string_view{};
}

}  // namespace slamsensor::firmware
