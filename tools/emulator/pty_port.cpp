#include "tools/emulator/pty_port.hpp"

#include <array>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kChunk = 1024;  // bytes moved at a time

}  // namespace

PtyPort::PtyPort(EmulatedPort& port, std::unique_ptr<PseudoTerminal> terminal, BaudRule rule)
    : port_(port), terminal_(std::move(terminal)), rule_(rule), plug_count_(port.plug_count()) {
}

void PtyPort::follow_cable() {
  // A cable that was out and in again since the last time is a new terminal, too.
  if (!port_.is_plugged() || port_.plug_count() != plug_count_) {
    terminal_->unplug();
  }
  plug_count_ = port_.plug_count();
  if (port_.is_plugged() && !terminal_->is_plugged()) {
    terminal_->plug_in();
  }
}

void PtyPort::exchange(Stamp now, Lateness& late) {
  follow_cable();
  has_host_ = terminal_->has_host();
  if (has_host_) {
    speak(now, late);
  } else {
    port_.host_discard();
  }
  listen(now);  // also the last words of a host that has gone
}

void PtyPort::speak(Stamp now, Lateness& late) {
  std::array<WireByte, kChunk> due;
  std::array<std::uint8_t, kChunk> bytes;
  for (std::size_t count = due.size(); count == due.size();) {
    count = port_.host_take(due, now);
    for (std::size_t i = 0; i < count; ++i) {
      bytes[i] = due[i].value;
      late.count(now - due[i].at);
    }
    if (count > 0) {
      lost_bytes_ += count - terminal_->write({bytes.data(), count});
    }
  }
}

void PtyPort::listen(Stamp now) {
  const auto host_baud = rule_ == BaudRule::AsOnALine ? terminal_->host_baud() : port_.device_baud();
  if (host_baud) {
    port_.set_host_baud(*host_baud);
  }
  std::array<std::uint8_t, kChunk> bytes;
  const std::size_t count = terminal_->read(bytes);
  port_.host_write({bytes.data(), count}, now);
}

}  // namespace slamsensor::tools
