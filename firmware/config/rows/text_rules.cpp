#include "firmware/config/rows/text_rules.hpp"

#include "firmware/lcm/lcm_sink.hpp"
#include "hal/rangefinder/point_record.hpp"
#include "hal/transport/reopen.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <charconv>
#include <utility>

namespace slamsensor::firmware::rows {
namespace {

// In the order of hal::Echo; a return is a distance and needs no code.
constexpr std::array<std::string_view, 5> kEchoNames = {"return", "none", "weak", "saturated", "fault"};

std::optional<hal::Echo> parse_echo(std::string_view name) {
  const auto found = std::find(kEchoNames.begin() + 1, kEchoNames.end(), name);
  if (found == kEchoNames.end()) {
    return std::nullopt;
  }
  return static_cast<hal::Echo>(found - kEchoNames.begin());
}

std::string text_of(std::string said, hal::Echo echo) {
  return std::move(said) + '=' + std::string(kEchoNames[static_cast<std::size_t>(echo)]);
}

template <typename Value>
std::vector<Value> parsed(const std::vector<std::string>& items,
                          std::optional<Value> (*parse)(std::string_view)) {
  std::vector<Value> values;
  for (const std::string& item : items) {
    if (std::optional<Value> value = parse(item)) {
      values.push_back(std::move(*value));
    }
  }
  return values;
}

/// The switch of each name.
std::array<bool*, kNmeaSentenceNames.size()> switches(NmeaConfig& config) {
  NmeaSentences& chosen = config.sentences;
  return {&chosen.rmc, &chosen.gga, &chosen.gbs, &chosen.hdt,
          &chosen.ths, &chosen.gst, &config.zda, &chosen.pslma};
}

/// Whether a character is signed differs between processors.
bool is_ascii_character(char c) {
  return static_cast<unsigned char>(c) < 0x80;
}

bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), is_ascii_character);
}

bool is_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

/// Printable and without spaces.
bool is_word(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
}

/// Absolute, without control characters. Bytes beyond ASCII are the file system's affair.
bool is_path(std::string_view text, std::size_t size_max) {
  return text.starts_with('/') && text.size() <= size_max &&
         std::none_of(text.begin(), text.end(),
                      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7F'; });
}

bool is_device_path(std::string_view text) {
  return is_path(text, 160);
}

bool is_map_name(std::string_view text) {
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

bool is_interface(std::string_view text) {
  return !text.empty() && text.size() <= 15 && text != "." && text != ".." && is_word(text) &&
         text.find_first_of("/:") == std::string_view::npos;
}

bool is_ip_address(std::string_view text) {
  const std::string address(text);
  std::array<unsigned char, sizeof(in6_addr)> binary{};
  return address.size() == std::string_view(address.c_str()).size() &&
         (inet_pton(AF_INET, address.c_str(), binary.data()) == 1 ||
          inet_pton(AF_INET6, address.c_str(), binary.data()) == 1);
}

bool is_sentence(std::string_view text) {
  return std::find(kNmeaSentenceNames.begin(), kNmeaSentenceNames.end(), text) != kNmeaSentenceNames.end();
}

}  // namespace

std::optional<hal::PointCode> parse_point_code(std::string_view item) {
  hal::PointCode code;
  const auto [end, error] = std::from_chars(item.data(), item.data() + item.size(), code.number);
  const std::string_view rest = item.substr(static_cast<std::size_t>(end - item.data()));
  if (error != std::errc() || !rest.starts_with('=')) {
    return std::nullopt;
  }
  const std::optional<hal::Echo> echo = parse_echo(rest.substr(1));
  if (!echo) {
    return std::nullopt;
  }
  code.echo = *echo;
  return code;
}

std::optional<hal::PointText> parse_point_text(std::string_view item) {
  const std::size_t equals = item.rfind('=');
  if (equals == std::string_view::npos || equals == 0 || equals > hal::kPointTextMax) {
    return std::nullopt;
  }
  const std::string_view text = item.substr(0, equals);
  const std::optional<hal::Echo> echo = parse_echo(item.substr(equals + 1));
  if (!echo || std::any_of(text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; })) {
    return std::nullopt;
  }
  return hal::PointText{std::string(text), *echo};
}

std::vector<hal::PointCode> point_codes(const std::vector<std::string>& items) {
  return parsed(items, parse_point_code);
}

std::vector<hal::PointText> point_texts(const std::vector<std::string>& items) {
  return parsed(items, parse_point_text);
}

std::vector<std::string> texts_of(const std::vector<hal::PointCode>& codes) {
  std::vector<std::string> items;
  for (const hal::PointCode& code : codes) {
    items.push_back(text_of(std::to_string(code.number), code.echo));
  }
  return items;
}

std::vector<std::string> texts_of(const std::vector<hal::PointText>& texts) {
  std::vector<std::string> items;
  for (const hal::PointText& text : texts) {
    items.push_back(text_of(text.text, text.echo));
  }
  return items;
}

std::vector<std::string> chosen_sentences(const NmeaConfig& config) {
  NmeaConfig copy = config;
  const auto is_on = switches(copy);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < is_on.size(); ++i) {
    if (*is_on[i]) {
      names.emplace_back(kNmeaSentenceNames[i]);
    }
  }
  return names;
}

void choose_sentences(const std::vector<std::string>& names, NmeaConfig& config) {
  const auto is_on = switches(config);
  for (std::size_t i = 0; i < is_on.size(); ++i) {
    *is_on[i] = std::find(names.begin(), names.end(), kNmeaSentenceNames[i]) != names.end();
  }
}

constinit const TextRule kDevicePath = {"an absolute path of at most 160 characters", is_device_path};
constinit const TextRule kOptionalDevicePath = {
    "an absolute path of at most 160 characters, or \"\"",
    [](std::string_view text) { return text.empty() || is_device_path(text); }};
constinit const TextRule kFolder = {"an absolute path of at most 200 characters",
                                    [](std::string_view text) { return is_path(text, 200); }};
constinit const TextRule kSocketPath = {"an absolute path of at most 107 characters",
                                        [](std::string_view text) { return is_path(text, 107); }};
constinit const TextRule kMapName = {"1 to 64 characters out of A-Z, a-z, 0-9, _ and -", is_map_name};
constinit const TextRule kInterface = {"the name of a network interface, 1 to 15 characters", is_interface};
constinit const TextRule kIioDevice = {"1 to 160 printable characters", [](std::string_view text) {
                                         return !text.empty() && text.size() <= hal::kDeviceNameMax &&
                                                is_printable(text);
                                       }};
constinit const TextRule kIpAddress = {"an IPv4 or IPv6 address", is_ip_address};
constinit const TextRule kLcmUrl = {
    "an LCM URL of at most 200 characters, udpm://GROUP:PORT?ttl=N or memq://, or \"\"",
    [](std::string_view text) {
      return text.size() <= 200 && is_word(text) && (text.empty() || resolve_lcm_url(text, nullptr));
    }};
constinit const TextRule kLcmPrefix = {
    "at most 48 printable characters without spaces",
    [](std::string_view text) { return text.size() <= 48 && is_word(text); }};
constinit const TextRule kLcmChannel = {
    "at most 63 printable characters without spaces",
    [](std::string_view text) { return text.size() <= 63 && is_word(text); }};
constinit const TextRule kGpioChip = {"at most 64 printable characters", [](std::string_view text) {
                                        return text.size() <= 64 && is_printable(text);
                                      }};
constinit const TextRule kTerminator = {"1 to 4 characters of ASCII", [](std::string_view text) {
                                          return !text.empty() && text.size() <= 4 && is_ascii(text);
                                        }};
constinit const TextRule kRecordPrefix = {"at most 8 characters of ASCII", [](std::string_view text) {
                                            return text.size() <= 8 && is_ascii(text);
                                          }};
constinit const TextRule kSeparator = {"one printable character, or \"\"", [](std::string_view text) {
                                         return text.size() <= 1 && is_printable(text);
                                       }};
constinit const TextRule kCommand = {"at most 64 characters of ASCII", [](std::string_view text) {
                                       return text.size() <= 64 && is_ascii(text);
                                     }};
constinit const TextRule kPointCode = {
    "\"NUMBER=ECHO\" with none, weak, saturated or fault as ECHO",
    [](std::string_view text) { return parse_point_code(text).has_value(); }};
constinit const TextRule kPointText = {
    "\"TEXT=ECHO\" with 1 to 32 printable characters and none, weak, saturated or fault",
    [](std::string_view text) { return parse_point_text(text).has_value(); }};
constinit const TextRule kSentence = {
    "out of \"RMC\", \"GGA\", \"GBS\", \"HDT\", \"THS\", \"GST\", \"ZDA\" and \"PSLMA\"", is_sentence};

}  // namespace slamsensor::firmware::rows
