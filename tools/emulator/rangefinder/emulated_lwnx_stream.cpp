#include "tools/emulator/rangefinder/emulated_lwnx.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr std::uint8_t kStreamId = 30;
constexpr std::uint8_t kStatisticsId = 35;
constexpr std::uint8_t kRawId = 40;
constexpr std::uint8_t kCmId = 44;
constexpr std::uint8_t kMmId = 45;
constexpr std::uint8_t kLaserId = 50;
constexpr Stamp kStatisticsPeriod = std::chrono::milliseconds(500);

/// Two bytes of an old SF30: the high one marked by its top bit, seven bits of the distance in each.
std::array<std::uint8_t, 2> sf30_bytes(unsigned cm) {
  return {static_cast<std::uint8_t>(0x80U | (cm >> 7U & 0x7FU)), static_cast<std::uint8_t>(cm & 0x7FU)};
}

}  // namespace

LwnxStream EmulatedLwnx::stream() const {
  if (!is_lwnx_) {
    return LwnxStream::Off;
  }
  return product_.stream(static_cast<std::uint32_t>(registers_.value(kStreamId))).value_or(LwnxStream::Off);
}

double EmulatedLwnx::rate_hz(LwnxStream stream) const {
  const bool has_switch = product_.find(product_.ids.high_speed) != nullptr;
  const bool is_fast = !has_switch || registers_.value(product_.ids.high_speed) == 1;
  if (stream == LwnxStream::Raw && is_fast) {
    return settings_.full_speed_hz;
  }
  return product_.rate_hz(registers_.value(product_.ids.update_rate)).value_or(1.0);
}

void EmulatedLwnx::retime(Stamp now) {
  raw_.clear();
  raw_measured_.clear();
  const LwnxStream kind = stream();
  const bool is_text = !is_lwnx_ && (text_stream_ || settings_.legacy == LwnxLegacyStream::Sf30Binary);
  if (kind == LwnxStream::Raw || kind == LwnxStream::Cm || kind == LwnxStream::Mm || is_text) {
    machine_.timer.start_after(now, rate_hz(kind));
  } else {
    machine_.timer.stop();
  }
}

bool EmulatedLwnx::tells_strength() const {
  const LwnxStream kind = stream();
  if (kind == LwnxStream::Raw || !is_lwnx_) {
    return false;
  }
  if (kind == LwnxStream::Mm && product_.mm_signals > 0) {
    return true;
  }
  const std::uint64_t bits = registers_.value(product_.ids.distance_output);
  for (std::size_t bit = 0; bit < product_.fields.size(); ++bit) {
    if ((bits >> bit & 1U) != 0 && product_.fields[bit] == LwnxField::Strength) {
      return true;
    }
  }
  return false;
}

LwnxReading EmulatedLwnx::measure(Stamp at) {
  if (registers_.value(kLaserId) == 0 || error_is_on(at)) {
    return {};
  }
  const LwnxIds& ids = product_.ids;
  return reader_.read(look(scene_, at, machine_.faults),
                      {registers_.signed_value(ids.zero_offset) * product_.zero_offset_unit_m,
                       static_cast<std::uint32_t>(registers_.value(ids.lost_counter)), tells_strength()});
}

void EmulatedLwnx::shoot(Stamp at) {
  if (error_is_on(at)) {
    return;  // text comes instead
  }
  const LwnxReading reading = measure(at);
  const LwnxStream kind = stream();
  if (!is_lwnx_) {
    stream_text(reading, at);
  } else if (kind == LwnxStream::Raw) {
    stream_raw(reading, at);
  } else {
    stream_packet(kind, reading, at);
  }
}

void EmulatedLwnx::stream_packet(LwnxStream stream, const LwnxReading& reading, Stamp at) {
  data_.clear();
  const std::uint64_t bits = registers_.value(product_.ids.distance_output);
  if (stream == LwnxStream::Cm) {
    pack_cm(product_, bits, reading, reader_.recent(reading), data_);
    put_record(kCmId, {&at, 1}, at);
  } else {
    pack_mm(product_, bits, reading, reader_.recent(reading), data_);
    put_record(kMmId, {&at, 1}, at);
  }
}

void EmulatedLwnx::stream_raw(const LwnxReading& reading, Stamp at) {
  append_little_endian(distance_word(reading, reading.range_m, {100.0, 2, product_.no_return}), 2, raw_);
  raw_measured_.push_back(at);
  if (raw_measured_.size() < settings_.raw_readings) {
    return;
  }
  data_.assign(1, settings_.raw_readings);
  data_.insert(data_.end(), raw_.begin(), raw_.end());
  put_record(kRawId, raw_measured_, at);
  raw_.clear();
  raw_measured_.clear();
}

void EmulatedLwnx::stream_text(const LwnxReading& reading, Stamp at) {
  if (text_stream_) {
    const std::string line =
        text_answer(product_.text_style, *text_stream_, metres_text(text_range_m(reading)));
    packet_.assign(line.begin(), line.end());
  } else {
    constexpr double kCmMax = 16'383.0;
    const double cm = reading.is_lost ? kCmMax + 1.0 : std::round(reading.range_m * 100.0);
    const auto bytes =
        sf30_bytes(cm > kCmMax ? settings_.legacy_no_return_cm : static_cast<unsigned>(std::max(cm, 0.0)));
    packet_.assign(bytes.begin(), bytes.end());
  }
  machine_.outbox.put_record(packet_, {&at, 1}, at);
}

void EmulatedLwnx::put_record(std::uint8_t id, std::span<const Stamp> measured, Stamp at) {
  build_packet(id, LwnxAccess::Read, data_, packet_);
  if (machine_.faults.take(FaultKind::BadChecksum)) {
    packet_.back() ^= 0x5AU;
  }
  machine_.outbox.put_record(packet_, measured, at);
}

void EmulatedLwnx::send_statistics(Stamp now) {
  constexpr std::array<std::int64_t, 4> kWords = {2350, 62'000, 62'000,
                                                  12};  // temperature, bias, target, noise
  data_.clear();
  for (const std::int64_t word : kWords) {
    append_little_endian(word, 2, data_);
  }
  data_.push_back(static_cast<std::uint8_t>(registers_.value(kLaserId)));
  put_packet(kStatisticsId, LwnxAccess::Read, now);
  statistics_at_ = now + kStatisticsPeriod;
}

}  // namespace slamsensor::tools
