#include "hal/rangefinder/point_record.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr unsigned kStreakNeeded = 2;  // sound records in a row before one counts

}  // namespace

PointRecords::PointRecords(const PointLaserConfig& config, RangeCounters& counters)
    : counters_(counters),
      range_(config.range),
      unit_m_(config.unit_m),
      offset_m_(config.offset_m),
      codes_count_(std::min(config.codes.size(), kPointCodesMax)) {
  std::copy_n(config.codes.begin(), codes_count_, codes_.begin());
}

bool PointRecords::push(std::uint8_t byte) noexcept {
  ++position_;
  switch (take(byte)) {
    case Outcome::Nothing:
      return false;
    case Outcome::Unsound:
      if (streak_ >= kStreakNeeded) {
        counters_.count(RangeEvent::LocksLost);
      }
      streak_ = 0;
      return false;
    case Outcome::Sound:
      break;
  }
  streak_ = std::min(streak_ + 1, kStreakNeeded);
  if (streak_ < kStreakNeeded) {
    counters_.count(RangeEvent::ReadingsWithheld);
    return false;
  }
  return true;
}

void PointRecords::interrupt() noexcept {
  if (forget()) {
    streak_ = 0;
  }
}

void PointRecords::accept(const Measurement& raw, Strength strength, std::size_t bytes,
                          std::size_t bytes_after) noexcept {
  reading_ = judged(raw, strength, range_);
  end_ = position_ - bytes_after;
  begin_ = end_ - bytes;
}

Measurement PointRecords::measured(std::int64_t number, double scale) const noexcept {
  Measurement out;
  for (std::size_t i = 0; i < codes_count_; ++i) {
    if (codes_[i].number == number) {
      out.echo = codes_[i].echo;
      return out;
    }
  }
  out.range_m = static_cast<double>(number) * scale * unit_m_ + offset_m_;
  // What the device itself calls nothing must not become something by the offset.
  out.echo = number > 0 ? Echo::Return : Echo::None;
  return out;
}

namespace {

constexpr unsigned kDigitsMax = 12;
constexpr std::int64_t kNumberMax = 1'000'000'000'000'000;  // whole and fraction share one number
constexpr unsigned kHexDigitsMax = 8;

bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}

/// Takes the digits at the front of `text` into `number`; how many.
unsigned take_digits(std::string_view& text, std::int64_t& number) noexcept {
  unsigned count = 0;
  while (!text.empty() && is_digit(text.front()) && count <= kDigitsMax && number < kNumberMax) {
    number = number * 10 + (text.front() - '0');
    text.remove_prefix(1);
    ++count;
  }
  return count;
}

int hex_value(char c) noexcept {
  if (is_digit(c)) {
    return c - '0';
  }
  if (c >= 'A' && c <= 'F') {
    return c - 'A' + 10;
  }
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

}  // namespace

bool read_decimal(std::string_view text, char separator, AsciiNumber& into) noexcept {
  into = {};
  while (!text.empty() && text.front() == ' ') {
    text.remove_prefix(1);
  }
  const bool is_negative = !text.empty() && text.front() == '-';
  if (is_negative || (!text.empty() && text.front() == '+')) {
    text.remove_prefix(1);
  }
  const unsigned whole = take_digits(text, into.number);
  if (whole == 0 || whole > kDigitsMax) {
    return false;
  }
  if (!text.empty() && text.front() == '.') {
    text.remove_prefix(1);
    into.has_point = true;
    into.decimals = take_digits(text, into.number);
    if (into.decimals == 0 || whole + into.decimals > kDigitsMax) {
      return false;
    }
  }
  if (is_negative) {
    into.number = -into.number;
  }
  if (separator != '\0' && !text.empty() && text.front() == separator) {
    text.remove_prefix(1);
    into.has_strength = true;
    const unsigned digits = take_digits(text, into.strength);
    if (digits == 0 || digits > kDigitsMax) {
      return false;
    }
  }
  return text.empty();
}

bool read_hex(std::string_view text, AsciiNumber& into) noexcept {
  into = {};
  if (text.empty() || text.size() > kHexDigitsMax) {
    return false;
  }
  for (const char c : text) {
    const int value = hex_value(c);
    if (value < 0) {
      return false;
    }
    into.number = into.number * 16 + value;
  }
  return true;
}

namespace {

using Text = std::array<char, kPointTextMax>;

class AsciiRecords final : public PointRecords {
 public:
  AsciiRecords(const PointLaserConfig& config, RangeCounters& counters) : PointRecords(config, counters) {
    is_hex_ = config.record == PointRecord::AsciiHex;
    width_ = config.width;
    decimals_ = config.decimals;
    separator_ = config.strength_separator;
    prefix_is_optional_ = config.prefix_is == PointLaserConfig::Prefix::Optional;
    prefix_size_ = config.prefix.copy(prefix_.data(), prefix_.size());
    terminator_size_ = config.terminator.copy(terminator_.data(), terminator_.size());
    for (const PointText& text : config.texts) {
      text_sizes_[texts_] = text.text.copy(text_[texts_].data(), kPointTextMax);
      text_echoes_[texts_] = text.echo;
      ++texts_;
    }
  }

 private:
  Outcome take(std::uint8_t byte) noexcept override;
  bool forget() noexcept override;
  [[nodiscard]] Outcome judge_record() noexcept;
  [[nodiscard]] bool read(std::string_view record, AsciiNumber& number) const noexcept;

  /// A record and a terminator that is longer than what a record may be is not collected.
  static constexpr std::size_t kLineMax = kPointRecordMax + kPointTerminatorMax;
  std::array<char, kLineMax> line_{};
  std::size_t size_ = 0;
  bool is_skipping_ = true;  ///< to the next terminator: where the line began is not known
  std::array<char, kPointTerminatorMax> terminator_{};
  std::size_t terminator_size_ = 0;
  std::array<char, kPointPrefixMax> prefix_{};
  std::size_t prefix_size_ = 0;
  bool prefix_is_optional_ = false;
  bool is_hex_ = false;
  std::size_t width_ = 0;
  int decimals_ = -1;
  char separator_ = '\0';
  std::array<Text, kPointCodesMax> text_{};
  std::array<std::size_t, kPointCodesMax> text_sizes_{};
  std::array<Echo, kPointCodesMax> text_echoes_{};
  std::size_t texts_ = 0;
};

PointRecords::Outcome AsciiRecords::take(std::uint8_t byte) noexcept {
  if (size_ == line_.size()) {
    counters_.count(RangeEvent::LengthsRefused);
    counters_.count(RangeEvent::BytesSkipped, size_);
    // Keeps what may be the front of a terminator.
    std::copy(line_.end() - kPointTerminatorMax, line_.end(), line_.begin());
    size_ = kPointTerminatorMax;
    is_skipping_ = true;
  }
  line_[size_++] = static_cast<char>(byte);
  const std::string_view seen(line_.data(), size_);
  const std::string_view terminator(terminator_.data(), terminator_size_);
  if (seen.size() < terminator.size() || seen.substr(seen.size() - terminator.size()) != terminator) {
    return Outcome::Nothing;
  }
  if (is_skipping_) {
    is_skipping_ = false;
    counters_.count(RangeEvent::BytesSkipped, size_);
    size_ = 0;
    return Outcome::Unsound;
  }
  const Outcome outcome = judge_record();
  size_ = 0;
  return outcome;
}

PointRecords::Outcome AsciiRecords::judge_record() noexcept {
  const std::string_view record(line_.data(), size_ - terminator_size_);
  for (std::size_t i = 0; i < texts_; ++i) {
    if (record == std::string_view(text_[i].data(), text_sizes_[i])) {
      accept({.echo = text_echoes_[i]}, Strength::Unknown, size_, 0);
      return Outcome::Sound;
    }
  }
  AsciiNumber number;
  if (!read(record, number)) {
    counters_.count(RangeEvent::RecordsRefused);
    return Outcome::Unsound;
  }
  double scale = 1.0;
  for (unsigned i = 0; i < number.decimals; ++i) {
    scale *= 0.1;
  }
  Measurement raw = measured(number.number, scale);
  raw.strength = static_cast<double>(number.strength);
  accept(raw, number.has_strength ? Strength::Known : Strength::Unknown, size_, 0);
  return Outcome::Sound;
}

bool AsciiRecords::read(std::string_view record, AsciiNumber& number) const noexcept {
  if (width_ != 0 && record.size() != width_) {
    return false;
  }
  const std::string_view prefix(prefix_.data(), prefix_size_);
  if (record.substr(0, prefix.size()) == prefix) {
    record.remove_prefix(prefix.size());
  } else if (!prefix_is_optional_) {
    return false;
  }
  if (is_hex_) {
    return read_hex(record, number);
  }
  // Spaces fill up a width; where there is none they are strays.
  if (!read_decimal(record, separator_, number) || (width_ == 0 && record.front() == ' ')) {
    return false;
  }
  return (decimals_ < 0 || number.decimals == static_cast<unsigned>(decimals_)) &&
         (separator_ == '\0' || number.has_strength);
}

bool AsciiRecords::forget() noexcept {
  const bool had_any = size_ > 0;
  counters_.count(RangeEvent::BytesSkipped, size_);
  is_skipping_ = is_skipping_ || had_any;
  size_ = 0;
  return had_any;
}

/// A record counts when the next one begins: then it had no byte too many.
class Packed7Records final : public PointRecords {
 public:
  Packed7Records(const PointLaserConfig& config, RangeCounters& counters)
      : PointRecords(config, counters), bytes_(config.packed_bytes) {}

 private:
  Outcome take(std::uint8_t byte) noexcept override {
    if ((byte & kFirst) == 0) {
      if (size_ == 0) {
        counters_.count(RangeEvent::BytesSkipped);
      } else if (size_ <= bytes_) {
        number_ = (number_ << 7) | byte;
        ++size_;
      }
      return Outcome::Nothing;
    }
    const std::size_t size = size_;
    const std::int64_t number = number_;
    size_ = 1;
    number_ = byte & kBits;
    if (size != bytes_) {
      counters_.count(RangeEvent::BytesSkipped, size);
      return Outcome::Unsound;
    }
    accept(measured(number, 1.0), Strength::Unknown, bytes_, 1);
    return Outcome::Sound;
  }
  bool forget() noexcept override {
    // A whole record only waits for the next one, however slow the device is.
    const bool is_cut = size_ > 0 && size_ != bytes_;
    size_ = is_cut ? 0 : size_;
    return is_cut;
  }

  static constexpr std::uint8_t kFirst = 0x80;
  static constexpr std::uint8_t kBits = 0x7F;
  std::size_t bytes_;
  std::size_t size_ = 0;  ///< of the record under way; one more than it may have when it is too long
  std::int64_t number_ = 0;
};

}  // namespace

std::unique_ptr<PointRecords> make_point_records(const PointLaserConfig& config, RangeCounters& counters) {
  if (config.record == PointRecord::Packed7) {
    return std::make_unique<Packed7Records>(config, counters);
  }
  return std::make_unique<AsciiRecords>(config, counters);
}

}  // namespace slamsensor::hal
