#include "tools/spy/lcm_receiver.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr std::uint32_t kShortMagic = 0x4C433032;     // "LC02"
constexpr std::uint32_t kFragmentMagic = 0x4C433033;  // "LC03"
constexpr std::size_t kShortHeader = 8;
constexpr std::size_t kFragmentHeader = 20;
constexpr std::size_t kChannelMax = 63;

/// The big-endian number in `bytes`.
std::uint32_t number(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) {
    value = (value << 8U) | byte;
  }
  return value;
}

/// Takes the channel and its zero off the front of packet.data; false when there is none.
bool take_channel(LcmPacket& packet) noexcept {
  const auto head = packet.data.first(std::min(packet.data.size(), kChannelMax + 1));
  const auto end = std::find(head.begin(), head.end(), std::uint8_t{0});
  const auto size = static_cast<std::size_t>(end - head.begin());
  if (end == head.end() || size == 0) {
    return false;
  }
  packet.channel = {reinterpret_cast<const char*>(head.data()), size};
  packet.data = packet.data.subspan(size + 1);
  return true;
}

std::optional<LcmPacket> parse_short(std::span<const std::uint8_t> datagram) noexcept {
  LcmPacket packet;
  packet.sequence = number(datagram.subspan(4, 4));
  packet.data = datagram.subspan(kShortHeader);
  if (!take_channel(packet)) {
    return std::nullopt;
  }
  packet.message_bytes = static_cast<std::uint32_t>(packet.data.size());
  return packet;
}

std::optional<LcmPacket> parse_fragment(std::span<const std::uint8_t> datagram) noexcept {
  LcmPacket packet;
  packet.sequence = number(datagram.subspan(4, 4));
  packet.message_bytes = number(datagram.subspan(8, 4));
  packet.offset = number(datagram.subspan(12, 4));
  packet.fragment = static_cast<std::uint16_t>(number(datagram.subspan(16, 2)));
  packet.fragments = static_cast<std::uint16_t>(number(datagram.subspan(18, 2)));
  packet.data = datagram.subspan(kFragmentHeader);
  const bool has_channel = packet.fragment > 0 || take_channel(packet);
  const bool fits = packet.message_bytes <= kLcmMessageMax && packet.offset <= packet.message_bytes &&
                    packet.data.size() <= packet.message_bytes - packet.offset;
  if (!has_channel || !fits || packet.data.empty() || packet.fragment >= packet.fragments) {
    return std::nullopt;
  }
  return packet;
}

}  // namespace

std::optional<LcmPacket> parse_lcm_packet(std::span<const std::uint8_t> datagram) noexcept {
  if (datagram.size() < kShortHeader) {
    return std::nullopt;
  }
  const std::uint32_t magic = number(datagram.first(4));
  if (magic == kShortMagic) {
    return parse_short(datagram);
  }
  if (magic == kFragmentMagic && datagram.size() >= kFragmentHeader) {
    return parse_fragment(datagram);
  }
  return std::nullopt;
}

void LcmReassembler::forget(Sets::iterator set) {
  held_ -= set->bytes;
  sets_.erase(set);
}

void LcmReassembler::drop(Sets::iterator set) {
  forget(set);
  ++dropped_;
}

void LcmReassembler::keep_within_bounds() {
  while (sets_.size() > kSetsMax || held_ > kBytesMax) {
    drop(sets_.begin());
  }
}

LcmReassembler::Sets::iterator LcmReassembler::find_or_begin(std::uint64_t sender, const LcmPacket& packet) {
  auto found = std::find_if(sets_.begin(), sets_.end(), [&](const Set& set) {
    return set.sender == sender && set.sequence == packet.sequence;
  });
  if (found != sets_.end() &&
      (found->message_bytes != packet.message_bytes || found->fragments != packet.fragments)) {
    drop(found);  // the sender has started again, and counts from the same number
    found = sets_.end();
  }
  if (found == sets_.end()) {
    return sets_.insert(sets_.end(), {.sender = sender,
                                      .sequence = packet.sequence,
                                      .channel = {},
                                      .message_bytes = packet.message_bytes,
                                      .fragments = packet.fragments,
                                      .pieces = {},
                                      .bytes = 0});
  }
  return found;
}

void LcmReassembler::assemble(const Set& set) {
  channel_ = set.channel;
  message_.assign(set.message_bytes, 0);
  for (const auto& [fragment, piece] : set.pieces) {
    std::copy(piece.bytes.begin(), piece.bytes.end(), message_.begin() + piece.offset);
  }
}

std::optional<LcmMessageView> LcmReassembler::push(std::uint64_t sender, const LcmPacket& packet) {
  if (packet.fragments == 1 && packet.data.size() == packet.message_bytes) {
    return LcmMessageView{packet.channel, packet.data};
  }
  const auto set = find_or_begin(sender, packet);
  if (set->pieces.count(packet.fragment) > 0) {
    return std::nullopt;
  }
  // Together the fragments are as long as the message: more than that is a lie, and less at the end too.
  set->bytes += packet.data.size();
  held_ += packet.data.size();
  set->pieces[packet.fragment] = {packet.offset, {packet.data.begin(), packet.data.end()}};
  if (packet.fragment == 0) {
    set->channel = packet.channel;
  }
  const bool is_last = set->pieces.size() == set->fragments;
  if (set->bytes > set->message_bytes || (is_last && set->bytes < set->message_bytes)) {
    drop(set);
    return std::nullopt;
  }
  if (!is_last) {
    keep_within_bounds();
    return std::nullopt;
  }
  assemble(*set);
  forget(set);
  return LcmMessageView{channel_, message_};
}

namespace {

// Enough for a large map at once; the system grants as much of it as net.core.rmem_max allows.
constexpr int kReceiveBytes = 4 << 20;

template <typename T>
bool set_option(int fd, int level, int name, const T& value) {
  return ::setsockopt(fd, level, name, &value, sizeof value) == 0;
}

tl::unexpected<std::string> cannot(const firmware::LcmUrl& url, const char* what, int error) {
  std::string message = std::string("cannot ") + what + " " + url.text + ": " + std::strerror(error);
  if (error == ENODEV || error == ENETUNREACH) {
    message += "; no route for multicast, add one with: ip route add 224.0.0.0/4 dev IFACE";
  }
  return tl::unexpected(std::move(message));
}

}  // namespace

tl::expected<LcmReceiver, std::string> LcmReceiver::open(const firmware::LcmUrl& url) {
  if (url.transport != firmware::LcmTransport::Multicast) {
    return tl::unexpected(url.text + " has nothing to listen to: give a URL like udpm://239.255.76.67:7667");
  }
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) {
    return cannot(url, "open a socket for", errno);
  }
  LcmReceiver receiver(fd);
  set_option(fd, SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
  // Bound to the group, not to any address, so that nothing but the group is heard.
  const bool shared =
      set_option(fd, SOL_SOCKET, SO_REUSEADDR, 1) && set_option(fd, SOL_SOCKET, SO_REUSEPORT, 1);
  if (!shared || ::bind(fd, reinterpret_cast<const sockaddr*>(&url.group), sizeof url.group) != 0) {
    return cannot(url, "listen to", errno);
  }
  const ip_mreq membership{url.group.sin_addr, {htonl(INADDR_ANY)}};
  if (!set_option(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership)) {
    return cannot(url, "join the group of", errno);
  }
  return receiver;
}

LcmReceiver::LcmReceiver(LcmReceiver&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      datagram_(std::move(other.datagram_)),
      reassembler_(std::move(other.reassembler_)),
      refused_(other.refused_) {
}

LcmReceiver::~LcmReceiver() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
}

std::optional<LcmMessageView> LcmReceiver::next() {
  while (true) {
    sockaddr_in sender{};
    socklen_t length = sizeof sender;
    const ssize_t size = ::recvfrom(fd_, datagram_->data(), datagram_->size(), 0,
                                    reinterpret_cast<sockaddr*>(&sender), &length);
    if (size < 0) {
      return std::nullopt;
    }
    const auto packet = parse_lcm_packet({datagram_->data(), static_cast<std::size_t>(size)});
    if (!packet) {
      ++refused_;
      continue;
    }
    const std::uint64_t from = (std::uint64_t{sender.sin_addr.s_addr} << 16U) | sender.sin_port;
    if (const auto message = reassembler_.push(from, *packet)) {
      return message;
    }
  }
}

}  // namespace slamsensor::tools
