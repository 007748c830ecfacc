#include "tools/recording/playback.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace {

using namespace slamsensor;  // NOLINT(google-build-using-namespace)

/// The input cut into chunks: a byte says how many bytes of 16 each has.
class FuzzedTape final : public tools::ChunkSource {
 public:
  FuzzedTape(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  std::optional<Chunk> next() override {
    if (rest_.empty()) {
      return std::nullopt;
    }
    const std::size_t size = std::min<std::size_t>(16U * rest_.front(), rest_.size() - 1);
    const auto bytes = rest_.subspan(1, size);
    rest_ = rest_.subspan(1 + size);
    return Chunk{number_++, bytes};
  }

 private:
  std::span<const std::uint8_t> rest_;
  std::int64_t number_ = 0;
};

/// Does to a byte link what `operation` says that its driver did.
void follow(const tools::TapeOperation& operation, hal::ByteLink& link) {
  std::array<std::uint8_t, 1000> bytes{};
  switch (operation.op) {
    case firmware::TapeOp::ReadOk:
    case firmware::TapeOp::ReadBusy:
    case firmware::TapeOp::ReadDown: {
      const hal::ByteRead read = link.read(bytes);
      if (read.count > bytes.size() || (read.status != hal::LinkStatus::Ok && read.count > 0)) {
        __builtin_trap();
      }
      break;
    }
    case firmware::TapeOp::Write:
      static_cast<void>(link.write(operation.bytes));
      break;
    case firmware::TapeOp::SetBaud:
      static_cast<void>(link.set_baud(operation.baud));
      break;
    case firmware::TapeOp::Discard:
      link.discard_input();
      break;
    default:
      link.service(operation.time);
  }
}

void follow(const tools::TapeOperation& operation, hal::CanLink& link) {
  if (operation.op == firmware::TapeOp::CanSend) {
    static_cast<void>(link.send(operation.frame));
  } else if (operation.op == firmware::TapeOp::Service) {
    link.service(operation.time);
  } else if (const hal::CanRead got = link.receive(); got.frame.size > got.frame.data.size()) {
    __builtin_trap();
  }
}

void follow(const tools::TapeOperation& operation, const firmware::OwnedHeadLinks& links) {
  const bool is_pan_tilt =
      operation.link == firmware::HeadLink::PanTiltBytes || operation.link == firmware::HeadLink::PanTiltCan;
  hal::ByteLink* const bytes = is_pan_tilt ? links.pan_tilt_bytes.get() : links.rangefinder_bytes.get();
  hal::CanLink* const bus = is_pan_tilt ? links.pan_tilt_can.get() : links.rangefinder_can.get();
  if (!firmware::is_bus(operation.link) && bytes != nullptr) {
    follow(operation, *bytes);
  } else if (firmware::is_bus(operation.link) && bus != nullptr) {
    follow(operation, *bus);
  }
}

}  // namespace

// Whatever is on the tape, and to a driver that does just what is on it: steps do not go back in time, links
// hand out no more than fits, and a tape that is over says why.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedTape tape(data, size);
  FuzzedTape same_tape(data, size);
  tools::TapePlayer player(tape);
  const auto links = tools::playback_links(player);
  tools::TapeReader driver;
  hal::Stamp last{};
  while (const auto chunk = same_tape.next()) {
    driver.load(chunk->bytes);
    while (const auto operation = driver.next()) {
      if (operation->op != firmware::TapeOp::Step && operation->op != firmware::TapeOp::Command) {
        follow(*operation, links);
        continue;
      }
      const auto played = player.next();
      if (played && played->op == firmware::TapeOp::Step && played->time < last) {
        __builtin_trap();
      }
      last = played && played->op == firmware::TapeOp::Step ? played->time : last;
    }
  }
  while (player.next()) {
  }
  if (player.end() == tools::TapeEnd::None || player.end_text().empty()) {
    __builtin_trap();
  }
  return 0;
}
