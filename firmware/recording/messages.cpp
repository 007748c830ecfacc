#include "firmware/recording/messages.hpp"

#include "firmware/recording/big_endian.hpp"
#include "firmware/store/map_layout.hpp"

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kBlockHeadBytes = 8 + 8 + 8 + 4 + 4;
constexpr std::size_t kTextHeadBytes = 8 + 8 + 4 + 4;

std::int32_t checksum_of(std::span<const std::uint8_t> data) {
  return static_cast<std::int32_t>(crc32_of(data));
}

std::span<const std::uint8_t> bytes_of(std::string_view text) noexcept {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

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
