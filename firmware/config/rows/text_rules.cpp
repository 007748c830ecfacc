#include "firmware/config/rows/text_rules.hpp"

#include "firmware/config/rows/nmea_sentence_list.hpp"
#include "firmware/config/rows/point_lists.hpp"
#include "firmware/lcm/lcm_url.hpp"
#include "hal/transport/reopen_problem.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>

namespace slamsensor::firmware::rows {
namespace {

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
constinit const TextRule kProductName = {"1 to 32 printable characters", [](std::string_view text) {
                                           return !text.empty() && text.size() <= 32 && is_printable(text);
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
