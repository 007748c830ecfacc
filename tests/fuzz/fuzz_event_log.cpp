#include "firmware/recording/event_log.hpp"
#include "tools/recording/recording_file.hpp"

#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

// Whatever the file: events have the bounds that are promised, the reader comes to an end, bytes that it
// passed over are in the file, and messages within events are read within them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor;  // NOLINT(google-build-using-namespace)
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  tools::EventLogReader reader(stream);
  std::uint64_t before = 0;
  while (const auto event = reader.next()) {
    const bool is_bounded = !event->channel.empty() && event->channel.size() <= firmware::kEventChannelMax &&
                            event->data.size() <= firmware::kEventDataMax && event->data.size() < size;
    if (!is_bounded || reader.offset() <= before) {
      __builtin_trap();
    }
    before = reader.offset();
    if (const auto block = firmware::decode_block(event->data);
        block && block->data.size() > event->data.size()) {
      __builtin_trap();
    }
    if (const auto text = firmware::decode_text(event->data)) {
      static_cast<void>(firmware::parse_map_order(text->text));
    }
  }
  if (reader.bytes_passed_over() > size || reader.offset() != size) {
    __builtin_trap();
  }
  return 0;
}
