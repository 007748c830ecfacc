#include "firmware/output/nmea_sentence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace slamsensor::firmware {
namespace {

constexpr double kBitsPerByte = 10.0;  // with start and stop bit

// The longest that each sentence gets, "$" and CR LF included.
constexpr std::size_t kRmcMax = 67;
constexpr std::size_t kGgaMax = 82;
constexpr std::size_t kGbsMax = 44;
constexpr std::size_t kHdtMax = 20;
constexpr std::size_t kThsMax = 20;
constexpr std::size_t kGstMax = 72;
constexpr std::size_t kZdaMax = 39;
constexpr std::size_t kPslmaMax = 82;

std::size_t without_zda(const NmeaSentences& sentences) noexcept {
  return (sentences.rmc ? kRmcMax : 0) + (sentences.gga ? kGgaMax : 0) + (sentences.gbs ? kGbsMax : 0) +
         (sentences.hdt ? kHdtMax : 0) + (sentences.ths ? kThsMax : 0) + (sentences.gst ? kGstMax : 0) +
         (sentences.pslma ? kPslmaMax : 0);
}

constexpr int kDigitsMax = 20;  // of a 64-bit number

void append(NmeaField& field, char c) noexcept {
  if (field.size < field.characters.size()) {
    field.characters[field.size++] = c;
  }
}

/// Calls `put` for each decimal digit of `value`, zeros in front up to `width`.
template <typename Put>
void put_digits(std::uint64_t value, int width, Put put) noexcept {
  std::array<char, kDigitsMax> digits{};
  int count = 0;
  do {
    digits[static_cast<std::size_t>(count++)] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value != 0);
  for (int i = count; i < width; ++i) {
    put('0');
  }
  while (count > 0) {
    put(digits[static_cast<std::size_t>(--count)]);
  }
}

void append_digits(NmeaField& field, std::uint64_t value, int width) noexcept {
  put_digits(value, width, [&](char c) { append(field, c); });
}

std::uint64_t power_of_ten(int exponent) noexcept {
  std::uint64_t power = 1;
  for (int i = 0; i < exponent; ++i) {
    power *= 10;
  }
  return power;
}

}  // namespace

std::size_t nmea_epoch_bytes_max(const NmeaConfig& config) noexcept {
  return without_zda(config.sentences) + (config.zda ? kZdaMax : 0);
}

double NmeaLineLoad::bits_per_s() const noexcept {
  const double bytes_per_s =
      static_cast<double>(epoch_bytes) * rate_hz + static_cast<double>(zda_bytes) * std::min(rate_hz, 1.0);
  return bytes_per_s * kBitsPerByte;
}

NmeaLineLoad nmea_line_load(const NmeaConfig& config, double rate_hz, std::uint32_t baud) {
  return {without_zda(config.sentences), config.zda ? kZdaMax : 0, rate_hz, baud};
}

std::string to_text(const NmeaLineLoad& load) {
  const double bits = load.bits_per_s();
  const double usable = NmeaLineLoad::kShareMax * static_cast<double>(load.baud);
  std::array<char, 320> text{};
  std::snprintf(text.data(), text.size(),
                "%g epochs/s of up to %zu bytes%s are up to %.0f bit/s, %.0f %% of the line's %lu, of which "
                "%.0f %% are usable: take at least %.0f baud, at most %.2f epochs/s, or fewer sentences",
                load.rate_hz, load.epoch_bytes, load.zda_bytes > 0 ? " and a ZDA" : "", bits,
                100.0 * load.share(), static_cast<unsigned long>(load.baud), 100.0 * NmeaLineLoad::kShareMax,
                std::ceil(bits / NmeaLineLoad::kShareMax),
                std::floor(100.0 * load.rate_hz * usable / bits) / 100.0);
  return text.data();
}

std::uint8_t nmea_checksum(std::string_view characters) noexcept {
  unsigned sum = 0;
  for (const char c : characters) {
    sum ^= static_cast<unsigned char>(c);
  }
  return static_cast<std::uint8_t>(sum);
}

NmeaSentence::NmeaSentence(std::string_view address) noexcept {
  put('$');
  for (const char c : address) {
    put(c);
  }
}

void NmeaSentence::put(char c) noexcept {
  if (size_ + kTailLength >= characters_.size()) {
    too_long_ = true;
    return;
  }
  characters_[size_++] = c;
}

NmeaSentence& NmeaSentence::text(std::string_view field) noexcept {
  put(',');
  for (const char c : field) {
    put(c);
  }
  return *this;
}

NmeaSentence& NmeaSentence::blank(int count) noexcept {
  for (int i = 0; i < count; ++i) {
    put(',');
  }
  return *this;
}

NmeaSentence& NmeaSentence::integer(std::uint64_t field, int width) noexcept {
  put(',');
  put_digits(field, width, [this](char c) { put(c); });
  return *this;
}

NmeaSentence& NmeaSentence::fixed(double field, int decimals) noexcept {
  constexpr double kMagnitudeMax = 1e9;  // times 10^9 still fits 64 bits
  put(',');
  if (!(std::abs(field) <= kMagnitudeMax)) {
    return *this;
  }
  const auto unit = static_cast<double>(power_of_ten(decimals));
  const auto units = static_cast<std::uint64_t>(std::llround(std::abs(field) * unit));
  if (field < 0.0 && units != 0) {
    put('-');
  }
  put_units(units, decimals);
  return *this;
}

NmeaSentence& NmeaSentence::wrapped(double field_deg, int period_deg, int decimals) noexcept {
  put(',');
  if (!std::isfinite(field_deg)) {
    return *this;
  }
  const auto period = static_cast<double>(period_deg);
  const double rest = std::fmod(field_deg, period);
  const std::uint64_t unit = power_of_ten(decimals);
  const auto units = static_cast<std::uint64_t>(
      std::llround((rest < 0.0 ? rest + period : rest) * static_cast<double>(unit)));
  put_units(units % (static_cast<std::uint64_t>(period_deg) * unit), decimals);
  return *this;
}

/// `units` of the last decimal, with the point in its place.
void NmeaSentence::put_units(std::uint64_t units, int decimals) noexcept {
  const std::uint64_t unit = power_of_ten(decimals);
  put_digits(units / unit, 1, [this](char c) { put(c); });
  if (decimals > 0) {
    put('.');
    put_digits(units % unit, decimals, [this](char c) { put(c); });
  }
}

std::string_view NmeaSentence::finish() noexcept {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  if (too_long_) {
    return {};
  }
  const std::uint8_t sum = nmea_checksum({characters_.data() + 1, size_ - 1});
  const std::array<char, kTailLength> tail = {'*', kHex[sum >> 4], kHex[sum & 0xF], '\r', '\n'};
  for (std::size_t i = 0; i < tail.size(); ++i) {
    characters_[size_ + i] = tail[i];
  }
  return {characters_.data(), size_ + tail.size()};
}

NmeaAngle nmea_angle(double angle_deg, int degree_digits, int decimals) noexcept {
  NmeaAngle angle;
  if (!(std::abs(angle_deg) <= 360.0)) {
    return angle;
  }
  const std::uint64_t minute = power_of_ten(decimals);
  const std::uint64_t degree = 60 * minute;
  const auto units =
      static_cast<std::uint64_t>(std::llround(std::abs(angle_deg) * static_cast<double>(degree)));
  angle.negative = angle_deg < 0.0 && units != 0;
  append_digits(angle.field, units / degree, degree_digits);
  append_digits(angle.field, units % degree / minute, 2);
  append(angle.field, '.');
  append_digits(angle.field, units % minute, decimals);
  return angle;
}

NmeaTime nmea_time(std::chrono::nanoseconds utc) noexcept {
  using Hundredths = std::chrono::duration<std::int64_t, std::centi>;
  Hundredths rounded = std::chrono::floor<Hundredths>(utc);
  if (utc - rounded >= std::chrono::milliseconds(5)) {
    ++rounded;
  }
  const auto day = std::chrono::floor<std::chrono::days>(rounded);
  const std::chrono::year_month_day date{std::chrono::sys_days(day)};
  const auto in_day = static_cast<std::uint64_t>((rounded - day).count());
  NmeaTime result;
  result.day = static_cast<unsigned>(date.day());
  result.month = static_cast<unsigned>(date.month());
  result.year = static_cast<int>(date.year());
  append_digits(result.time, in_day / 360'000, 2);
  append_digits(result.time, in_day / 6'000 % 60, 2);
  append_digits(result.time, in_day / 100 % 60, 2);
  append(result.time, '.');
  append_digits(result.time, in_day % 100, 2);
  append_digits(result.date, result.day, 2);
  append_digits(result.date, result.month, 2);
  append_digits(result.date, static_cast<std::uint64_t>(result.year) % 100, 2);
  return result;
}

}  // namespace slamsensor::firmware
