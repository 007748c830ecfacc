#include "firmware/lcm/lcm_sink.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <lcm/lcm.h>
#include <netinet/in.h>
#include <optional>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

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

static_assert(kLcmChannelMax == LCM_MAX_CHANNEL_NAME_LENGTH);

// A message beyond this would be sent in LCM's fragments, which this sensor never needs.
constexpr std::size_t kPacketMax = 65499;

constexpr hal::ReopenConfig kReopen{.first = std::chrono::seconds(1), .longest = std::chrono::seconds(30)};

constexpr std::string_view kNoRoute =
    "no route for multicast; start slamsensor-multicast-route.service or: ip route add 224.0.0.0/4 dev IFACE";

// 0 when a datagram to the group would find a way, else why not (errno). liblcm finds out the same, but
// reports only the standard error output.
int find_route(const sockaddr_in& group) noexcept {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) {
    return errno;
  }
  const int result = ::connect(fd, reinterpret_cast<const sockaddr*>(&group), sizeof group);
  const int error = result == 0 ? 0 : errno;
  ::close(fd);
  return error;
}

/// In order.
std::vector<int> open_descriptors() {
  std::vector<int> open;
  std::error_code error;
  std::filesystem::directory_iterator entry("/proc/self/fd", error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    open.push_back(std::atoi(entry->path().filename().c_str()));
  }
  std::sort(open.begin(), open.end());
  return open;
}

// liblcm joins the group with the socket that it sends from, and never reads from that socket. The sensor
// only sends: the socket leaves the group, and keeps next to nothing of what is sent to its port. Any other
// socket that was opened meanwhile is in no group, and nothing changes for it.
void leave_group(const sockaddr_in& group, const std::vector<int>& open_before) {
  constexpr int kLeast = 0;  // the system takes its own minimum for it
  const ip_mreq membership{group.sin_addr, {htonl(INADDR_ANY)}};
  for (const int fd : open_descriptors()) {
    const bool is_new = !std::binary_search(open_before.begin(), open_before.end(), fd);
    if (is_new && ::setsockopt(fd, IPPROTO_IP, IP_DROP_MEMBERSHIP, &membership, sizeof membership) == 0) {
      static_cast<void>(::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &kLeast, sizeof kLeast));
    }
  }
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

LcmChannel::LcmChannel(std::string_view prefix, std::string_view name) noexcept {
  std::size_t size = 0;
  for (const std::string_view part : {prefix, name}) {
    const std::size_t taken = std::min(part.size(), kLcmChannelMax - size);
    std::copy_n(part.begin(), taken, text_.begin() + static_cast<std::ptrdiff_t>(size));
    size += taken;
  }
}

LcmSink::LcmSink(LcmUrl url)
    : url_(std::move(url)),
      reopen_(kReopen),
      problem_("not opened yet"),
      counters_({"lcm_published", "lcm_not_open", "lcm_send_failed", "lcm_opened", "lcm_open_failed"}) {
}

LcmSink::~LcmSink() {
  if (lcm_ != nullptr) {
    ::lcm_destroy(lcm_);
  }
}

void LcmSink::set_problem(std::string_view what, int error, std::string_view advice) noexcept {
  std::array<char, 192> text{};
  const char* const reason = error != 0 ? ::strerrordesc_np(error) : nullptr;
  const int size =
      std::snprintf(text.data(), text.size(), "LCM: %.*s%s%s; %.*s", static_cast<int>(what.size()),
                    what.data(), reason != nullptr ? ": " : "", reason != nullptr ? reason : "",
                    static_cast<int>(advice.size()), advice.data());
  const std::size_t used =
      std::clamp<std::size_t>(size < 0 ? 0 : static_cast<std::size_t>(size), 0, text.size() - 1);
  problem_ = hal::FixedText<160>({text.data(), used});
}

bool LcmSink::open() noexcept {
  if (url_.transport == LcmTransport::Multicast) {
    if (const int error = find_route(url_.group); error == ENETUNREACH || error == EHOSTUNREACH) {
      problem_ = hal::FixedText<160>(kNoRoute);
      return false;
    } else if (error != 0) {
      set_problem("cannot reach its group", error, "tried again by itself");
      return false;
    }
  }
  const std::vector<int> open_before = open_descriptors();
  lcm_ = ::lcm_create(url_.text.c_str());
  if (lcm_ == nullptr) {
    set_problem("liblcm refuses its URL", 0, "see lcm.url, and what liblcm wrote to the log");
    return false;
  }
  if (url_.transport == LcmTransport::Multicast) {
    leave_group(url_.group, open_before);
  }
  return true;
}

void LcmSink::service(hal::Stamp now) noexcept {
  if (is_open() || !reopen_.is_due(now)) {
    return;
  }
  if (!open()) {
    counters_.count(LcmEvent::OpenFailed);
    reopen_.failed(now);
    return;
  }
  counters_.count(LcmEvent::Opened);
  reopen_.opened(now);
  is_failing_ = false;
  problem_ = {};
}

bool LcmSink::publish(const LcmChannel& channel, std::span<const std::uint8_t> bytes) noexcept {
  if (channel.empty() || bytes.empty()) {
    return false;
  }
  if (tap_ != nullptr) {
    tap_->published(channel.view(), bytes);
  }
  if (!is_open()) {
    counters_.count(LcmEvent::NotOpen);
    return false;
  }
  errno = 0;
  const bool fits = channel.view().size() + 1 + bytes.size() <= kPacketMax;
  if (!fits || ::lcm_publish(lcm_, channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())) != 0) {
    const int error = fits ? errno : EMSGSIZE;
    counters_.count(LcmEvent::SendFailed);
    is_failing_ = true;
    set_problem("cannot send", error, "outputs go on without it");
    return false;
  }
  counters_.count(LcmEvent::Published);
  if (std::exchange(is_failing_, false)) {
    problem_ = {};
  }
  return true;
}

}  // namespace slamsensor::firmware
