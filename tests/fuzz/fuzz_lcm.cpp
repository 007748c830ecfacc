#include "firmware/lcm/lcm_messages.hpp"
#include "tools/spy/lcm_receiver.hpp"
#include "tools/top/top_frame.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace {

using namespace slamsensor;  // NOLINT(google-build-using-namespace)
using Bytes = std::span<const std::uint8_t>;

/// What is decoded is encoded again to the same bytes; a boolean may be any number that is not 0.
template <typename T>
void check_type(Bytes message) {
  const auto decoded = firmware::decode_lcm<T>(message);
  if (!decoded) {
    return;
  }
  std::vector<std::uint8_t> once(firmware::kLcmBytes<T>);
  std::vector<std::uint8_t> twice(firmware::kLcmBytes<T>);
  const bool fits = firmware::encode_lcm(*decoded, once) == message.size();
  const auto again = firmware::decode_lcm<T>(once);
  if (!fits || !again || firmware::encode_lcm(*again, twice) != once.size() || once != twice) {
    __builtin_trap();
  }
}

void check_message(Bytes message) {
  check_type<firmware::PoseMessage>(message);
  check_type<firmware::BotCorePose>(message);
  check_type<firmware::StatusMessage>(message);
  check_type<firmware::CountersMessage>(message);
  check_type<firmware::MapMessage>(message);
  check_type<firmware::ScanMessage>(message);
  check_type<firmware::RivalsMessage>(message);
}

}  // namespace

// Datagrams, each behind its length (two bytes): whole messages come out and none but those that fit, and any
// page can be drawn of whatever they said.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes rest(data, size);
  tools::LcmReassembler reassembler;
  tools::TopState state("S");
  hal::Stamp now{};
  while (rest.size() >= 2) {
    const std::size_t length = std::min<std::size_t>(rest[0] * 256U + rest[1], rest.size() - 2);
    const auto packet = tools::parse_lcm_packet(rest.subspan(2, length));
    rest = rest.subspan(2 + length);
    now += std::chrono::milliseconds(100);
    const auto message = packet ? reassembler.push(length % 3, *packet) : std::nullopt;
    if (reassembler.held_bytes() > tools::LcmReassembler::kBytesMax) {
      __builtin_trap();
    }
    if (message) {
      check_message(message->bytes);
      state.on_message(*message, now);
    }
  }
  if (size % 8 == 0) {  // drawing takes most of the time
    state.choice.page = static_cast<tools::TopPage>(size / 8 % 3);
    static_cast<void>(tools::draw_frame(state, 100, 30, now));
  }
  return 0;
}
