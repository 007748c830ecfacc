#include "firmware/lcm/lcm_url.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <charconv>
#include <optional>

namespace slamsensor::firmware {
namespace {

constexpr std::string_view kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";
constexpr std::string_view kDefaultGroup = "239.255.76.67";
constexpr int kDefaultPort = 7667;

std::optional<int> number(std::string_view text, int lowest, int highest) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < lowest || value > highest) {
    return std::nullopt;
  }
  return value;
}

/// What is before the first `mark`; `rest` becomes what is behind it.
std::string_view cut(std::string_view& rest, char mark) {
  const std::size_t end = std::min(rest.find(mark), rest.size());
  const std::string_view head = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return head;
}

/// What is wrong with `network`; empty: nothing.
std::string_view read_network(std::string_view network, LcmUrl& url) {
  const std::string_view group = cut(network, ':');
  const std::string address(group.empty() ? kDefaultGroup : group);
  url.group.sin_family = AF_INET;
  if (::inet_pton(AF_INET, address.c_str(), &url.group.sin_addr) != 1 ||
      !IN_MULTICAST(ntohl(url.group.sin_addr.s_addr))) {
    return "the group must be an IPv4 address from 224.0.0.0 to 239.255.255.255";
  }
  const std::optional<int> port = network.empty() ? kDefaultPort : number(network, 1, 65535);
  if (!port) {
    return "the port must be 1 to 65535";
  }
  url.group.sin_port = htons(static_cast<std::uint16_t>(*port));
  return {};
}

std::string_view read_options(std::string_view options, LcmUrl& url) {
  while (!options.empty()) {
    std::string_view value = cut(options, '&');
    const std::string_view key = cut(value, '=');
    const std::optional<int> n = number(value, 0, key == "ttl" ? 255 : 1 << 30);
    if ((key != "ttl" && key != "recv_buf_size") || !n) {
      return "the options are ttl=0..255 and recv_buf_size=BYTES";
    }
    url.ttl = key == "ttl" ? *n : url.ttl;
  }
  return {};
}

std::string_view read_url(std::string_view text, LcmUrl& url) {
  std::string_view rest = text;
  const std::size_t scheme = text.find("://");
  const std::string_view provider = text.substr(0, std::min(scheme, text.size()));
  if (text == "memq://") {
    url.transport = LcmTransport::Memory;
    return {};
  }
  if (scheme == std::string_view::npos || provider != "udpm") {
    return "only udpm://GROUP:PORT?ttl=N is sent to";
  }
  rest.remove_prefix(scheme + 3);
  const std::string_view network = cut(rest, '?');
  const std::string_view wrong = read_network(network, url);
  return wrong.empty() ? read_options(rest, url) : wrong;
}

}  // namespace

tl::expected<LcmUrl, hal::InitError> resolve_lcm_url(std::string_view configured, const char* environment) {
  std::string_view origin = "lcm.url";
  std::string_view text = configured;
  if (text.empty() && environment != nullptr && *environment != '\0') {
    origin = "LCM_DEFAULT_URL";
    text = environment;
  }
  text = text.empty() ? kDefaultUrl : text;
  LcmUrl url;
  url.text = text;
  const std::string_view wrong = read_url(text, url);
  if (!wrong.empty()) {
    return tl::unexpected(hal::InitError{std::string(origin) + " is \"" + url.text + "\": " +
                                         std::string(wrong) + ", for example " + std::string(kDefaultUrl)});
  }
  return url;
}

}  // namespace slamsensor::firmware
