#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

// Not by lcm-gen: its types do not name their members, which `slamsensor top` shows, and read any count or
// code.
namespace slamsensor::firmware {

/// How the size of an array member is given.
enum class LcmArray : std::uint8_t { Fixed, ByMember };

/// One member of an LCM type whose members are all primitive: its name, its primitive type ("int64_t",
/// "byte", ...) and, for a one-dimensional array, its size as text (a number or the name of the member that
/// holds it).
struct LcmMember {
  std::string_view name;
  std::string_view type;
  std::string_view size;  ///< empty: not an array
  LcmArray array = LcmArray::Fixed;
};

namespace lcm_detail {

constexpr std::uint64_t step(std::uint64_t value, std::uint8_t c) noexcept {
  const auto carried = static_cast<std::uint64_t>(static_cast<std::int64_t>(value) >> 55);
  // The generator adds a signed character; all of ours are ASCII.
  return ((value << 8U) ^ carried) + c;
}

constexpr std::uint64_t step(std::uint64_t value, std::string_view text) noexcept {
  value = step(value, static_cast<std::uint8_t>(text.size()));
  for (const char c : text) {
    value = step(value, static_cast<std::uint8_t>(c));
  }
  return value;
}

}  // namespace lcm_detail

/// The eight bytes, most significant first, that a message of the type with these members begins with
/// (lcm-gen 1.3.1).
constexpr std::uint64_t lcm_fingerprint(std::initializer_list<LcmMember> members) noexcept {
  std::uint64_t value = 0x12345678;
  for (const LcmMember& member : members) {
    value = lcm_detail::step(value, member.name);
    value = lcm_detail::step(value, member.type);
    const bool is_array = !member.size.empty();
    value = lcm_detail::step(value, static_cast<std::uint8_t>(is_array ? 1 : 0));
    if (is_array) {
      value = lcm_detail::step(value, static_cast<std::uint8_t>(member.array == LcmArray::ByMember ? 1 : 0));
      value = lcm_detail::step(value, member.size);
    }
  }
  return (value << 1U) | (value >> 63U);
}

/// Text of an LCM message: `byte name[kSize]`, filled up with zeros.
template <std::size_t kSize>
using LcmText = std::array<char, kSize>;

/// The first `kSize` bytes of `text`, then zeros.
template <std::size_t kSize>
[[nodiscard]] constexpr LcmText<kSize> to_lcm_text(std::string_view text) noexcept {
  LcmText<kSize> out{};
  for (std::size_t i = 0; i < kSize && i < text.size(); ++i) {
    out[i] = text[i];
  }
  return out;
}

/// What stands before the first zero, at most all of it.
template <std::size_t kSize>
[[nodiscard]] constexpr std::string_view text_of(const LcmText<kSize>& text) noexcept {
  const std::string_view all(text.data(), kSize);
  return all.substr(0, all.find('\0'));
}

/// A message of fixed size: `members(message, visit)` calls visit(name, member) for each member in the order
/// of the .lcm file. Members are bool (boolean), char (byte), intN_t, float, double, and arrays of those of
/// one or two dimensions.
template <typename T>
concept LcmMessage = requires(T message) {
  T::members(message, [](std::string_view, auto&) {});
};

namespace lcm_detail {

template <typename T>
struct ArrayOf {
  using Element = T;
  static constexpr std::size_t kDimensions = 0;
};
template <typename T, std::size_t kCount>
struct ArrayOf<std::array<T, kCount>> {
  using Element = typename ArrayOf<T>::Element;
  static constexpr std::size_t kDimensions = 1 + ArrayOf<T>::kDimensions;
};

template <typename T>
constexpr std::string_view type_name() noexcept {
  if constexpr (std::same_as<T, bool>) {
    return "boolean";
  } else if constexpr (std::same_as<T, char>) {
    return "byte";
  } else if constexpr (std::same_as<T, std::int8_t>) {
    return "int8_t";
  } else if constexpr (std::same_as<T, std::int32_t>) {
    return "int32_t";
  } else if constexpr (std::same_as<T, std::int64_t>) {
    return "int64_t";
  } else {
    static_assert(std::same_as<T, double>);
    return "double";
  }
}

constexpr std::uint64_t step_number(std::uint64_t value, std::size_t number) noexcept {
  std::array<char, 20> digits{};
  std::size_t first = digits.size();
  do {
    digits[--first] = static_cast<char>('0' + number % 10);
    number /= 10;
  } while (number != 0);
  return step(value, std::string_view(digits.data() + first, digits.size() - first));
}

template <typename T>
constexpr std::uint64_t step_dimensions(std::uint64_t value) noexcept {
  if constexpr (ArrayOf<T>::kDimensions == 0) {
    return value;
  } else {
    value = step_number(step(value, std::uint8_t{0}), std::tuple_size_v<T>);
    return step_dimensions<typename T::value_type>(value);
  }
}

template <typename T>
constexpr std::size_t size_of() noexcept {
  if constexpr (ArrayOf<T>::kDimensions == 0) {
    return sizeof(T);
  } else {
    return std::tuple_size_v<T> * size_of<typename T::value_type>();
  }
}

template <std::size_t kBytes>
using Bits = std::conditional_t<kBytes == 1, std::uint8_t,
                                std::conditional_t<kBytes == 4, std::uint32_t, std::uint64_t>>;

/// Writes members where `out` points to; the caller has made sure of the room.
class Writer {
 public:
  explicit constexpr Writer(std::uint8_t* out) noexcept : out_(out) {}

  template <typename T>
  constexpr void put(const T& member) noexcept {
    if constexpr (ArrayOf<T>::kDimensions > 0) {
      for (const auto& element : member) {
        put(element);
      }
    } else {
      const auto bits = std::bit_cast<Bits<sizeof(T)>>(member);
      for (std::size_t i = sizeof(T); i-- > 0;) {
        *out_++ = static_cast<std::uint8_t>(bits >> (8U * i));
      }
    }
  }

 private:
  std::uint8_t* out_;
};

/// Reads members from where `in` points to; the caller has made sure of the length.
class Reader {
 public:
  explicit constexpr Reader(const std::uint8_t* in) noexcept : in_(in) {}

  template <typename T>
  constexpr void get(T& member) noexcept {
    if constexpr (ArrayOf<T>::kDimensions > 0) {
      for (auto& element : member) {
        get(element);
      }
    } else {
      std::uint64_t bits = 0;
      for (std::size_t i = 0; i < sizeof(T); ++i) {
        bits = (bits << 8U) | *in_++;
      }
      if constexpr (std::same_as<T, bool>) {
        member = bits != 0;
      } else {
        member = std::bit_cast<T>(static_cast<Bits<sizeof(T)>>(bits));
      }
    }
  }

 private:
  const std::uint8_t* in_;
};

template <LcmMessage T>
constexpr std::uint64_t fingerprint_of() noexcept {
  std::uint64_t value = 0x12345678;
  T message{};
  T::members(message, [&value]<typename M>(std::string_view name, M&) {
    value = step(step(value, name), type_name<typename ArrayOf<M>::Element>());
    value = step_dimensions<M>(step(value, static_cast<std::uint8_t>(ArrayOf<M>::kDimensions)));
  });
  return std::rotl(value, 1);
}

template <LcmMessage T>
constexpr std::size_t bytes_of() noexcept {
  std::size_t bytes = sizeof(std::uint64_t);
  T message{};
  T::members(message, [&bytes]<typename M>(std::string_view, M&) { bytes += size_of<M>(); });
  return bytes;
}

}  // namespace lcm_detail

/// The eight bytes that a message of type T begins with, as lcm-gen has them.
template <LcmMessage T>
inline constexpr std::uint64_t kLcmFingerprint = lcm_detail::fingerprint_of<T>();

/// Bytes of every message of type T, its fingerprint included.
template <LcmMessage T>
inline constexpr std::size_t kLcmBytes = lcm_detail::bytes_of<T>();

/// The fingerprint of a message; none when it is too short to have one.
[[nodiscard]] constexpr std::optional<std::uint64_t> lcm_fingerprint_in(
    std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() < sizeof(std::uint64_t)) {
    return std::nullopt;
  }
  std::int64_t value = 0;
  lcm_detail::Reader(bytes.data()).get(value);
  return static_cast<std::uint64_t>(value);
}

/// Writes `message` in LCM's encoding into `out` and returns its length, kLcmBytes<T>; returns 0 and writes
/// nothing when `out` is shorter than that.
template <LcmMessage T>
[[nodiscard]] constexpr std::size_t encode_lcm(const T& message, std::span<std::uint8_t> out) noexcept {
  if (out.size() < kLcmBytes<T>) {
    return 0;
  }
  lcm_detail::Writer writer(out.data());
  writer.put(static_cast<std::int64_t>(kLcmFingerprint<T>));
  T::members(message, [&writer](std::string_view, const auto& member) { writer.put(member); });
  return kLcmBytes<T>;
}

/// The message in `bytes`; none unless they begin with the fingerprint of T, are exactly as long as it, and
/// its counts, indices and enumerations are within their bounds (`is_sound`). Other numbers may be anything,
/// NaN included.
template <LcmMessage T>
[[nodiscard]] constexpr std::optional<T> decode_lcm(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() != kLcmBytes<T> || lcm_fingerprint_in(bytes) != kLcmFingerprint<T>) {
    return std::nullopt;
  }
  std::optional<T> message(std::in_place);
  lcm_detail::Reader reader(bytes.data() + sizeof(std::uint64_t));
  T::members(*message, [&reader](std::string_view, auto& member) { reader.get(member); });
  if (!is_sound(*message)) {
    message.reset();
  }
  return message;
}

/// Most landmarks that a list in chunks can have; more are not sent.
inline constexpr std::size_t kChunkedLandmarksMax = 100'000'000;

/// Messages for `landmarks` at `kPerChunk` each; one for none at all, so that a reader hears of it.
template <std::size_t kPerChunk>
[[nodiscard]] constexpr std::uint32_t chunks_of(std::size_t landmarks) noexcept {
  const std::size_t sent = std::min(landmarks, kChunkedLandmarksMax);
  return static_cast<std::uint32_t>(std::max<std::size_t>(1, (sent + kPerChunk - 1) / kPerChunk));
}

/// Sets landmarks, chunk, chunks and count of `message`; false when there is no chunk of that number.
template <std::size_t kPerChunk, typename Message>
[[nodiscard]] constexpr bool number_chunk(std::size_t landmarks, std::uint32_t chunk,
                                          Message& message) noexcept {
  const std::uint32_t chunks = chunks_of<kPerChunk>(landmarks);
  if (chunk >= chunks) {
    return false;
  }
  const std::size_t sent = std::min(landmarks, kChunkedLandmarksMax);
  message.landmarks = static_cast<std::int32_t>(sent);
  message.chunk = static_cast<std::int32_t>(chunk);
  message.chunks = static_cast<std::int32_t>(chunks);
  message.count = static_cast<std::int32_t>(std::min(kPerChunk, sent - chunk * kPerChunk));
  return true;
}

/// Whether `message` is numbered as number_chunk does it.
template <std::size_t kPerChunk, typename Message>
[[nodiscard]] constexpr bool is_sound_chunk(const Message& message) noexcept {
  Message expected;
  return message.landmarks >= 0 && message.chunk >= 0 &&
         static_cast<std::size_t>(message.landmarks) <= kChunkedLandmarksMax &&
         number_chunk<kPerChunk>(static_cast<std::size_t>(message.landmarks),
                                 static_cast<std::uint32_t>(message.chunk), expected) &&
         message.chunks == expected.chunks && message.count == expected.count;
}

}  // namespace slamsensor::firmware
