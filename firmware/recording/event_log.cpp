#include "firmware/recording/event_log.hpp"

#include "firmware/store/map_file.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr std::array<std::string_view, 4> kKinds = {"reset", "freeze", "unfreeze", "load"};

}  // namespace

std::string text_of(const MapOrder& order) {
  return std::string(kKinds[static_cast<std::size_t>(order.kind)]) + ' ' + std::to_string(order.scan);
}

std::optional<MapOrder> parse_map_order(std::string_view text) noexcept {
  const std::size_t space = text.find(' ');
  for (std::size_t kind = 0; kind < kKinds.size() && space != std::string_view::npos; ++kind) {
    if (text.substr(0, space) != kKinds[kind]) {
      continue;
    }
    MapOrder order{static_cast<MapCommand>(kind)};
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + space + 1, end, order.scan);
    return error == std::errc() && rest == end ? std::optional(order) : std::nullopt;
  }
  return std::nullopt;
}

namespace {

constexpr std::size_t kPendingBytes = std::size_t{256} * 1024;
constexpr int kMode = 0640;

constexpr std::size_t kBlockHeadBytes = 8 + 8 + 8 + 4 + 4;
constexpr std::size_t kTextHeadBytes = 8 + 8 + 4 + 4;

std::int32_t checksum_of(std::span<const std::uint8_t> data) {
  return static_cast<std::int32_t>(crc32_of(data));
}

std::span<const std::uint8_t> bytes_of(std::string_view text) noexcept {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Bytes of the events, of those one after the other in `events`, that end within the first `count` bytes.
std::size_t whole_events(std::span<const std::uint8_t> events, std::size_t count) {
  std::size_t end = 0;
  while (end + kEventHeadBytes <= count) {
    const auto head = events.subspan(end);
    const std::size_t size = kEventHeadBytes + read_big_endian<std::uint32_t>(head.subspan(20)) +
                             read_big_endian<std::uint32_t>(head.subspan(24));
    if (end + size > count) {
      break;
    }
    end += size;
  }
  return end;
}

}  // namespace

tl::expected<EventLogWriter, hal::InitError> EventLogWriter::create(const std::filesystem::path& path,
                                                                    ExistingFile existing) {
  const int flags = O_WRONLY | O_CREAT | O_CLOEXEC | (existing == ExistingFile::Refuse ? O_EXCL : O_TRUNC);
  const int fd = ::open(path.c_str(), flags, kMode);
  if (fd < 0) {
    const char* const remedy =
        errno == EEXIST ? "choose another name" : "choose a folder that exists and may be written to";
    return tl::unexpected(hal::InitError{"recording " + path.string() +
                                         " cannot be made: " + std::strerror(errno) + "; " + remedy});
  }
  return EventLogWriter(fd);
}

EventLogWriter::EventLogWriter(EventLogWriter&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      error_(other.error_),
      pending_(std::move(other.pending_)),
      on_file_(other.on_file_),
      events_(other.events_) {
  other.pending_.clear();
}

EventLogWriter::~EventLogWriter() {
  static_cast<void>(close());
}

bool EventLogWriter::write(std::int64_t utime_us, std::string_view channel,
                           std::span<const std::uint8_t> data) {
  if (fd_ < 0 || error_ != 0 || channel.empty() || channel.size() > kEventChannelMax ||
      data.size() > kEventDataMax) {
    return false;
  }
  append_big_endian(pending_, kEventSync);
  append_big_endian(pending_, static_cast<std::int64_t>(events_));
  append_big_endian(pending_, utime_us);
  append_big_endian(pending_, static_cast<std::int32_t>(channel.size()));
  append_big_endian(pending_, static_cast<std::int32_t>(data.size()));
  pending_.insert(pending_.end(), channel.begin(), channel.end());
  pending_.insert(pending_.end(), data.begin(), data.end());
  ++events_;
  return pending_.size() < kPendingBytes || flush();
}

bool EventLogWriter::flush() {
  std::span<const std::uint8_t> left = pending_;
  while (error_ == 0 && !left.empty()) {
    const ssize_t written = ::write(fd_, left.data(), left.size());
    if (written >= 0) {
      left = left.subspan(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      on_file_ += whole_events(pending_, pending_.size() - left.size());
      fail(errno);
    }
  }
  on_file_ += error_ == 0 ? pending_.size() : 0;
  pending_.clear();
  return error_ == 0;
}

void EventLogWriter::fail(int error) noexcept {
  error_ = error;
  // A pipe cannot be cut; its reader sees a truncated tail, which is normal in an event log.
  static_cast<void>(::ftruncate(fd_, static_cast<off_t>(on_file_)) == 0);
}

bool EventLogWriter::close() {
  if (fd_ < 0) {
    return error_ == 0;
  }
  const bool is_flushed = flush();
  if (is_flushed && ::fdatasync(fd_) != 0 && errno != EINVAL && errno != EROFS) {
    error_ = errno;
  }
  if (::close(std::exchange(fd_, -1)) != 0 && error_ == 0) {
    error_ = errno;
  }
  return error_ == 0;
}

void encode(const Block& block, std::vector<std::uint8_t>& out) {
  out.clear();
  out.reserve(kBlockHeadBytes + block.data.size());
  append_big_endian(out, kBlockFingerprint);
  append_big_endian(out, block.utime_us);
  append_big_endian(out, block.number);
  append_big_endian(out, checksum_of(block.data));
  append_big_endian(out, static_cast<std::int32_t>(block.data.size()));
  out.insert(out.end(), block.data.begin(), block.data.end());
}

void encode(const Text& text, std::vector<std::uint8_t>& out) {
  out.clear();
  out.reserve(kTextHeadBytes + text.text.size() + 1);
  append_big_endian(out, kTextFingerprint);
  append_big_endian(out, text.utime_us);
  append_big_endian(out, checksum_of(bytes_of(text.text)));
  append_big_endian(out, static_cast<std::int32_t>(text.text.size() + 1));
  out.insert(out.end(), text.text.begin(), text.text.end());
  out.push_back(0);
}

std::optional<Block> decode_block(std::span<const std::uint8_t> message) {
  if (message.size() < kBlockHeadBytes || read_big_endian<std::uint64_t>(message) != kBlockFingerprint) {
    return std::nullopt;
  }
  const auto data = message.subspan(kBlockHeadBytes);
  if (read_big_endian<std::uint32_t>(message.subspan(28)) != data.size() ||
      read_big_endian<std::int32_t>(message.subspan(24)) != checksum_of(data)) {
    return std::nullopt;
  }
  return Block{read_big_endian<std::int64_t>(message.subspan(8)),
               read_big_endian<std::int64_t>(message.subspan(16)), data};
}

std::optional<Text> decode_text(std::span<const std::uint8_t> message) {
  if (message.size() <= kTextHeadBytes || read_big_endian<std::uint64_t>(message) != kTextFingerprint) {
    return std::nullopt;
  }
  const auto data = message.subspan(kTextHeadBytes, message.size() - kTextHeadBytes - 1);
  if (read_big_endian<std::uint32_t>(message.subspan(20)) != data.size() + 1 || message.back() != 0 ||
      read_big_endian<std::int32_t>(message.subspan(16)) != checksum_of(data)) {
    return std::nullopt;
  }
  return Text{read_big_endian<std::int64_t>(message.subspan(8)),
              {reinterpret_cast<const char*>(data.data()), data.size()}};
}

}  // namespace slamsensor::firmware
