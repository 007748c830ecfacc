#include "hal/pantilt/canopen/sdo_client.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

// Whatever frame comes, a reply tells no more bytes than a frame has room for.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::hal;  // NOLINT(google-build-using-namespace)
  if (size == 0) {
    return 0;
  }
  CanFrame frame;
  frame.id = 0x581;
  frame.size = data[0];  // also more than a frame can have
  std::copy_n(data + 1, std::min<std::size_t>(size - 1, frame.data.size()), frame.data.begin());
  const auto reply = parse_sdo_reply(frame);
  if (!reply) {
    return 0;
  }
  const bool is_segment = reply->kind == SdoReplyKind::Segment;
  if (reply->size > (is_segment ? 7 : 4) || reply->toggle > 1 || frame.size != 8) {
    __builtin_trap();
  }
  return 0;
}
