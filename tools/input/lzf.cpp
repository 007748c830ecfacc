#include "tools/input/lzf.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kLiteralTokens = 32;  // a token below this is followed by token + 1 bytes as they are
constexpr std::size_t kLongLength = 7;      // a length of this goes on in the next byte
constexpr std::size_t kLeastCopy = 2;       // added to every length of a copy

// Reads `packed` from its start, never past its end.
class Bytes {
 public:
  explicit Bytes(std::string_view packed) : packed_(packed) {}

  bool empty() const { return packed_.empty(); }

  std::optional<std::size_t> take_byte() {
    if (packed_.empty()) {
      return std::nullopt;
    }
    const auto byte = static_cast<unsigned char>(packed_.front());
    packed_.remove_prefix(1);
    return byte;
  }

  std::optional<std::string_view> take(std::size_t count) {
    if (count > packed_.size()) {
      return std::nullopt;
    }
    const std::string_view bytes = packed_.substr(0, count);
    packed_.remove_prefix(count);
    return bytes;
  }

 private:
  std::string_view packed_;
};

// What has been unpacked so far; refuses to exceed the size it was made for.
class Unpacked {
 public:
  explicit Unpacked(std::size_t size_bytes) : size_bytes_(size_bytes) { bytes_.reserve(size_bytes); }

  bool append(std::string_view literal) {
    if (literal.size() > size_bytes_ - bytes_.size()) {
      return false;
    }
    bytes_.insert(bytes_.end(), literal.begin(), literal.end());
    return true;
  }

  // Repeats `length` bytes that start `distance` back. They may overlap what is being written: a run repeats
  // itself.
  bool repeat(std::size_t distance, std::size_t length) {
    if (distance > bytes_.size() || length > size_bytes_ - bytes_.size()) {
      return false;
    }
    for (std::size_t from = bytes_.size() - distance, i = 0; i < length; ++i) {
      bytes_.push_back(bytes_[from + i]);
    }
    return true;
  }

  bool complete() const { return bytes_.size() == size_bytes_; }
  std::vector<char> release() { return std::move(bytes_); }

 private:
  std::size_t size_bytes_;
  std::vector<char> bytes_;
};

bool unpack_copy(std::size_t token, Bytes& packed, Unpacked& unpacked) {
  std::size_t length = token >> 5;
  if (length == kLongLength) {
    const auto more = packed.take_byte();
    if (!more) {
      return false;
    }
    length += *more;
  }
  const auto low = packed.take_byte();
  if (!low) {
    return false;
  }
  const std::size_t distance = ((token & 0x1FU) << 8U | *low) + 1;
  return unpacked.repeat(distance, length + kLeastCopy);
}

bool unpack_token(std::size_t token, Bytes& packed, Unpacked& unpacked) {
  if (token >= kLiteralTokens) {
    return unpack_copy(token, packed, unpacked);
  }
  const auto literal = packed.take(token + 1);
  return literal && unpacked.append(*literal);
}

}  // namespace

std::optional<std::vector<char>> unpack_lzf(std::string_view packed, std::size_t size_bytes) {
  if (size_bytes / kLzfExpansionMax > packed.size()) {
    return std::nullopt;
  }
  Bytes bytes(packed);
  Unpacked unpacked(size_bytes);
  while (!bytes.empty()) {
    if (!unpack_token(*bytes.take_byte(), bytes, unpacked)) {
      return std::nullopt;
    }
  }
  if (!unpacked.complete()) {
    return std::nullopt;
  }
  return unpacked.release();
}

}  // namespace slamsensor::tools
