#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// Whether `name` can be that of a map: 1 to 64 characters out of A-Z a-z 0-9 _ -.
[[nodiscard]] bool is_map_name(std::string_view name);

/// Whether `seconds` since 1970-01-01 UTC lie before the year 10000.
[[nodiscard]] bool is_utc(std::int64_t seconds);

/// "2026-11-23T13:05:09Z"; a time that is not `is_utc` is the nearest that is.
[[nodiscard]] std::string utc_text(std::int64_t seconds);

/// "20261123T130509Z", for names of files.
[[nodiscard]] std::string utc_name(std::int64_t seconds);

/// The bytes in quotes as printable ASCII, anything else as \xHH; what is longer than 32 is cut.
[[nodiscard]] std::string printable_bytes(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::string printable_bytes(std::string_view text);

}  // namespace slamsensor::firmware
