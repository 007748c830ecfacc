#include "tools/emulator/rangefinder/tf03_frame.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slamsensor::tools {

Tf03Settings tf03_settings(BenewakeModel model) {
  Tf03Settings settings;
  settings.model = model;
  switch (model) {
    case BenewakeModel::Tf03:
      break;
    case BenewakeModel::TfMini:
      settings.no_return_cm = 65'535;
      settings.strength_min = 20.0;
      settings.strength_of_weak = 10;
      break;
    case BenewakeModel::TfMiniPlus:
      settings.no_return_cm = 0;
      settings.strength_min = 100.0;
      settings.strength_of_weak = 60;
      settings.strength_of_blinded = 65'535;
      break;
    case BenewakeModel::TfMiniS:
      settings.no_return_cm = 65'535;  // -1: too faint
      settings.strength_min = 100.0;
      settings.strength_of_weak = 60;
      settings.strength_of_blinded = 65'535;
      break;
    case BenewakeModel::Tf02:
      settings.no_return_cm = 2'200;
      break;
  }
  return settings;
}

std::uint32_t nearest_tf03_rate(double rate_hz) {
  const double limited = std::clamp(rate_hz, 1.0, 10'000.0);
  const double decade = std::pow(10.0, std::min(3.0, std::floor(std::log10(limited))));
  return static_cast<std::uint32_t>(std::llround(std::round(limited / decade) * decade));
}

void set_rate(Tf03Settings& settings, double rate_hz) {
  settings.saved.rate_hz = nearest_tf03_rate(rate_hz);
}

namespace {

constexpr std::uint8_t kFrameMark = 0x59;
constexpr std::uint8_t kCommandMark = 0x5A;
constexpr std::size_t kCommandMin = 4;
constexpr std::size_t kCommandMax = 16;
constexpr Stamp kPause = std::chrono::milliseconds(100);
constexpr std::uint16_t kTooBright = 0xFFFE;      // -2 of the TFmini-S
constexpr std::uint16_t kTooSunny = 0xFFFC;       // -4
constexpr std::uint32_t kStrengthRateMax = 1000;  // above it only the distance is told

std::uint8_t low(unsigned value) {
  return static_cast<std::uint8_t>(value & 0xFFU);
}

std::uint8_t sum_of(std::span<const std::uint8_t> bytes) {
  return low(std::accumulate(bytes.begin(), bytes.end(), 0U));
}

std::uint16_t nothing_word(const Tf03Settings& settings, const Tf03Parameters& parameters) {
  if (settings.model != BenewakeModel::Tf03) {
    return settings.no_return_cm;
  }
  return parameters.over_range_cm != 0 ? parameters.over_range_cm : settings.no_return_cm;
}

std::uint16_t strength_word(const Tf03Settings& settings, const Sight& sight) {
  switch (sight.kind) {
    case SightKind::Weak:
      return settings.strength_of_weak;
    case SightKind::Saturated:
      return settings.strength_of_blinded;
    case SightKind::Target:
      return static_cast<std::uint16_t>(settings.strength.of(sight));
    case SightKind::Nothing:
    case SightKind::Error:
      break;
  }
  return settings.strength_of_nothing;
}

bool is_beyond(const Tf03Settings& settings, const Tf03Parameters& parameters, double cm) {
  const bool is_limited = settings.model == BenewakeModel::Tf03 && parameters.over_range_cm != 0;
  return cm > (is_limited ? parameters.over_range_cm : 65'000.0);
}

/// Bytes 6 and 7 of the frame.
std::array<std::uint8_t, 2> model_bytes(const Tf03Settings& settings, const Tf03Words& words) {
  switch (settings.model) {
    case BenewakeModel::Tf03:
      return {0, 0};
    case BenewakeModel::TfMini:
      return {words.distance < 500 ? std::uint8_t{2} : std::uint8_t{7}, 0};  // short or long range
    case BenewakeModel::Tf02:
      return {words.is_trusted ? std::uint8_t{8} : std::uint8_t{1}, 6};
    case BenewakeModel::TfMiniPlus:
    case BenewakeModel::TfMiniS:
      break;
  }
  const auto raw = static_cast<unsigned>(std::lround((settings.temperature_c + 256.0) * 8.0));
  return {low(raw), low(raw >> 8U)};
}

}  // namespace

Tf03Words tf03_words(const Tf03Settings& settings, const Tf03Parameters& parameters, const Sight& sight) {
  Tf03Words words{nothing_word(settings, parameters), strength_word(settings, sight), false};
  const double cm = std::round(sight.range_m * 100.0);
  const bool is_strong = words.strength >= settings.strength_min;
  const bool is_hidden = sight.kind == SightKind::Saturated && settings.model != BenewakeModel::Tf03;
  if (sight.has_echo() && is_strong && !is_hidden && !is_beyond(settings, parameters, cm)) {
    words.distance = static_cast<std::uint16_t>(std::max(cm, 0.0));
    words.is_trusted = true;
  } else if (settings.model == BenewakeModel::TfMiniS && sight.kind == SightKind::Saturated) {
    words.distance = kTooBright;
  } else if (settings.model == BenewakeModel::TfMiniS && sight.kind == SightKind::Error) {
    words.distance = kTooSunny;
  }
  if (parameters.rate_hz > kStrengthRateMax) {
    words.strength = 0;
  }
  return words;
}

void build_tf03_frame(const Tf03Settings& settings, const Tf03Words& words, std::vector<std::uint8_t>& out) {
  const auto [sixth, seventh] = model_bytes(settings, words);
  out = {kFrameMark,
         kFrameMark,
         low(words.distance),
         low(words.distance / 256U),
         low(words.strength),
         low(words.strength / 256U),
         sixth,
         seventh};
  out.push_back(sum_of(out));
}

void build_tf03_can(const Tf03Words& words, std::vector<std::uint8_t>& out) {
  out = {low(words.distance), low(words.distance / 256U), low(words.strength), low(words.strength / 256U)};
  out.resize(8);
}

std::vector<std::uint8_t> with_tf03_sum(std::vector<std::uint8_t> body) {
  body.push_back(sum_of(body));
  return body;
}

std::optional<std::vector<std::uint8_t>> Tf03Receiver::push(std::uint8_t byte, Stamp at) {
  if (at - last_byte_ > kPause) {
    buffer_.clear();
  }
  last_byte_ = at;
  if (buffer_.empty() && byte != kCommandMark) {
    return std::nullopt;
  }
  buffer_.push_back(byte);
  return take();
}

std::optional<std::vector<std::uint8_t>> Tf03Receiver::take() {
  while (buffer_.size() >= 2) {
    const std::size_t length = buffer_[1];
    const bool is_possible = length >= kCommandMin && length <= kCommandMax;
    if (is_possible && buffer_.size() < length) {
      return std::nullopt;
    }
    if (is_possible) {
      const std::span<const std::uint8_t> command(buffer_.data(), length);
      if (sum_of(command.first(length - 1)) == command.back()) {
        std::vector<std::uint8_t> whole(command.begin(), command.end());
        buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(length));
        return whole;
      }
    }
    ++refused_;
    buffer_.erase(buffer_.begin(), std::find(buffer_.begin() + 1, buffer_.end(), kCommandMark));
  }
  return std::nullopt;
}

}  // namespace slamsensor::tools
