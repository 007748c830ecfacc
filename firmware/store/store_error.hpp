#pragma once

#include "firmware/store/map_text.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace slamsensor::firmware {

enum class StoreFault : std::uint8_t {
  Name,     ///< not a name that a map can have, or one that is taken
  Missing,  ///< there is no such map: no reason for alarm at a first start
  Refused,  ///< what is there is no good map, or what is to be saved is none
  Io,       ///< disk full, read-only, not allowed, broken, ...
  InUse,    ///< another process has the folder
};

struct StoreError {
  StoreFault fault = StoreFault::Io;
  std::string message;  ///< what, where and what to do, in one line
};

[[nodiscard]] inline tl::unexpected<StoreError> store_failure(StoreFault fault, std::string message) {
  return tl::unexpected(StoreError{fault, std::move(message)});
}

/// The error that `name` is not `is_map_name`.
[[nodiscard]] inline tl::unexpected<StoreError> bad_map_name(std::string_view name) {
  return store_failure(StoreFault::Name, "map name " + printable_bytes(name) +
                                             ": use 1 to 64 characters out of A-Z, a-z, 0-9, _ and -");
}

}  // namespace slamsensor::firmware
