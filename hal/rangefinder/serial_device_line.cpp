#include "hal/rangefinder/serial_device_line.hpp"

#include <algorithm>

namespace slamsensor::hal {

LineRates rates_from(std::uint32_t first, std::span<const std::uint32_t> others) noexcept {
  LineRates rates{first};
  std::size_t count = 1;
  for (const std::uint32_t rate : others) {
    if (rate != first && count < rates.size()) {
      rates[count++] = rate;
    }
  }
  return rates;
}

SerialDeviceLine::SerialDeviceLine(ByteLink& link, const LineRates& rates) noexcept
    : link_(link), rates_(rates) {
}

void SerialDeviceLine::service(Stamp now) noexcept {
  link_.service(now);
  if (link_.baud() != baud()) {
    apply_rate();
    if (link_.is_up() && link_.baud() != baud()) {
      next_rate();  // this adapter cannot run at it
    }
  }
}

void SerialDeviceLine::next_rate() noexcept {
  if (kept_ && rate_ != *kept_) {
    other_ = rate_;
    rate_ = *kept_;
  } else {
    rate_ = after(kept_ ? other_ : rate_);
    if (kept_ && rate_ == *kept_) {
      rate_ = after(rate_);
    }
  }
  apply_rate();
}

std::size_t SerialDeviceLine::after(std::size_t rate) const noexcept {
  const std::size_t next = (rate + 1) % rates_.size();
  return rates_[next] == 0 ? 0 : next;
}

void SerialDeviceLine::set_baud(std::uint32_t baud) noexcept {
  const auto known = std::find(rates_.begin(), rates_.end(), baud);
  if (known != rates_.end()) {
    rate_ = static_cast<std::size_t>(known - rates_.begin());
  } else {
    rate_ = rates_.size() - 1;
    rates_[rate_] = baud;
  }
  apply_rate();
}

void SerialDeviceLine::apply_rate() noexcept {
  // Down: the link uses the rate when it comes back, or cannot and no reply will say so.
  (void)link_.set_baud(baud());
  link_.discard_input();
}

std::span<const std::uint8_t> SerialDeviceLine::read() noexcept {
  if (read_in_step_ >= kBytesPerStep) {
    return {};
  }
  const ByteRead got = link_.read(chunk_);
  if (got.status != LinkStatus::Ok) {
    return {};
  }
  const std::size_t count = std::min(got.count, chunk_.size());
  read_in_step_ += count;
  log_.note(count, got.stamp);
  return {chunk_.data(), count};
}

}  // namespace slamsensor::hal
