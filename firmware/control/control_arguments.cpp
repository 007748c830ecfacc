#include "firmware/control/control_arguments.hpp"

#include "firmware/config/setting.hpp"
#include "firmware/config/suggestion.hpp"
#include "firmware/control/control_words.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace slamsensor::firmware {
namespace {

using Parsed = tl::expected<void, ControlError>;

constexpr std::size_t kNameMax = 64;
constexpr std::array<std::string_view, 2> kModeNames = {"continuous", "single"};

tl::unexpected<ControlError> refuse(std::string message) {
  return tl::unexpected(ControlError{ControlErrorCode::Value, std::move(message)});
}

Parsed parse_name(std::string_view text, ControlRequest& request) {
  if (!map_name_allowed(text)) {
    return refuse(quoted(text) + " is no name: 1 to 64 of A-Z a-z 0-9 _ - are allowed");
  }
  request.name = text;
  return {};
}

Parsed parse_choice(std::string_view text, std::span<const std::string_view> names, std::size_t& choice) {
  const auto found = std::find(names.begin(), names.end(), text);
  choice = static_cast<std::size_t>(found - names.begin());
  if (found != names.end()) {
    return {};
  }
  std::string allowed;
  for (const std::string_view name : names) {
    allowed += (allowed.empty() ? "" : ", ") + std::string(name);
  }
  return refuse(quoted(text) + " is not allowed; allowed: " + allowed);
}

Parsed parse_key(std::string_view& text, ControlRequest& request) {
  const std::string_view key = take_word(text);
  if (!find_setting(key)) {
    const std::string near = key.size() <= kNameMax ? suggest_key(key) : std::string();
    return refuse(quoted(key) + " is no setting; " + (near.empty() ? "" : "did you mean " + near + "? ") +
                  "config list names all");
  }
  request.name = key;
  return {};
}

/// `word` as a number in the range of the setting `path`.
tl::expected<double, ControlError> parse_real(std::string_view word, std::string_view path) {
  const Setting& setting = settings()[*find_setting(path)];
  const auto& range = std::get<RealSetting>(setting.kind);
  double value = 0.0;
  const auto end = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end.ec != std::errc() || end.ptr != word.data() + word.size() || !std::isfinite(value) ||
      value < range.min || value > range.max) {
    return refuse(std::string(setting.key()) + ": " + quoted(word) +
                  " is not allowed; allowed: " + allowed_text(setting));
  }
  return value * range.scale;
}

Parsed parse_datum(std::string_view& text, ControlRequest& request) {
  const std::array<std::pair<std::string_view, double*>, 4> fields = {
      {{"datum.latitude_deg", &request.datum.latitude_deg},
       {"datum.longitude_deg", &request.datum.longitude_deg},
       {"datum.height_m", &request.datum.height_m},
       {"datum.bearing_deg", &request.datum.bearing_deg}}};
  for (const auto& [path, value] : fields) {
    const auto read = parse_real(take_word(text), path);
    if (!read) {
      return tl::unexpected(read.error());
    }
    *value = *read;
  }
  return {};
}

}  // namespace

bool map_name_allowed(std::string_view name) noexcept {
  return !name.empty() && name.size() <= kNameMax && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

Parsed parse_arguments(std::string_view& text, ControlRequest& request) {
  std::size_t choice = 0;
  switch (request.command->arguments) {
    case ControlArguments::None:
      return {};
    case ControlArguments::OptionalJson:
      request.form = text == "json" ? ReplyForm::Json : ReplyForm::Text;
      text.remove_prefix(text == "json" ? text.size() : 0);
      return {};
    case ControlArguments::OptionalCommand:
      while (!text.empty()) {
        request.name += (request.name.empty() ? "" : " ") + std::string(take_word(text));
      }
      return {};
    case ControlArguments::OptionalName:
      return text.empty() ? Parsed() : parse_name(take_word(text), request);
    case ControlArguments::Name:
      return parse_name(take_word(text), request);
    case ControlArguments::Mode:
      return parse_choice(take_word(text), kModeNames, choice).map([&] {
        request.mode = static_cast<ScanMode>(choice);
      });
    case ControlArguments::Level:
      return parse_choice(take_word(text), kLogLevelNames, choice).map([&] {
        request.level = static_cast<LogLevel>(choice);
      });
    case ControlArguments::Datum:
      return parse_datum(text, request);
    case ControlArguments::Key:
      return parse_key(text, request);
    case ControlArguments::KeyValue:
      return parse_key(text, request).map([&] {
        request.value = text;
        text = {};
      });
  }
  return {};
}

}  // namespace slamsensor::firmware
