#include "firmware/config/list_config.hpp"
#include "firmware/config/load_config.hpp"

#include <cstdint>
#include <cstdlib>
#include <string_view>

/// Any bytes are either refused with at least one message of one line, or give a configuration in which every
/// key is listed and every rule holds.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::firmware;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto loaded = load_config_text(text, "fuzz");
  if (!loaded) {
    if (loaded.error().empty()) {
      std::abort();
    }
    for (const ConfigError& error : loaded.error()) {
      if (error.message.empty() || error.text().find('\n') != std::string::npos) {
        std::abort();
      }
    }
    return 0;
  }
  if (list_config(*loaded).empty() || !check_config(*loaded).empty()) {
    std::abort();
  }
  return 0;
}
