#include "hal/pantilt/canopen/canopen_pan_tilt.hpp"
#include "tests/fuzz/wires/fuzz_can_link.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace {

using namespace slamsensor::hal;  // NOLINT(google-build-using-namespace)

// What a drive says of the objects that a start-up reads.
std::uint32_t object_value(std::uint32_t key, std::uint32_t node, std::uint32_t status) {
  switch (key) {
    case 0x100000:
      return 0x00020192;
    case 0x140001:
      return 0x200 + node;
    case 0x180001:
      return 0x40000180 + node;
    case 0x604100:
      return status;
    case 0x607D01:
      return static_cast<std::uint32_t>(-200000);
    case 0x607D02:
      return 200000;
    case 0x607F00:
      return 50000;
    case 0x608100:
      return 1000;
    case 0x608300:
      return 100000;
    case 0x650200:
      return 0x25;
    default:
      return 1;
  }
}

/// Two drives that let themselves be started up, on a bus where anything else may turn up: PDOs, heartbeats,
/// emergencies, replies that nobody asked for.
class DrivesLink final : public slamsensor::tests::FuzzCanLink {
 public:
  explicit DrivesLink(std::span<const std::uint8_t> input)
      : FuzzCanLink(input, {0x181, 0x182, 0x701, 0x702, 0x081, 0x082, 0x581, 0x282}) {}

  /// Whether the drives still answer.
  bool answers = true;

  [[nodiscard]] CanRead receive() noexcept override {
    if (reply_) {
      const CanRead got{LinkStatus::Ok, *reply_, now()};
      reply_.reset();
      return got;
    }
    return FuzzCanLink::receive();
  }

  [[nodiscard]] LinkStatus send(const CanFrame& frame) noexcept override {
    const std::uint32_t node = frame.id & 0x7F;
    if (answers && (frame.id & 0x780U) == 0x600 && node < status_.size()) {
      reply_ = answer(frame, node);
    }
    return LinkStatus::Ok;
  }

 private:
  CanFrame answer(const CanFrame& request, std::uint32_t node) noexcept {
    const std::uint32_t key = le_number(request, 1, 2) << 8 | request.data[3];
    CanFrame reply = request;
    reply.id = 0x580 + node;
    if (request.data[0] == 0x40) {
      reply.data[0] = 0x43;
      put_le(reply, 4, 4, key == 0x606100 ? mode_[node] : object_value(key, node, status_[node]));
      return reply;
    }
    const std::uint32_t value = le_number(request, 4, 4);
    if (key == 0x604000) {
      obey(value, node);
    } else if (key == 0x606000) {
      mode_[node] = value & 0xFF;
    }
    reply.data[0] = 0x60;
    return reply;
  }

  void obey(std::uint32_t control, std::uint32_t node) noexcept {
    switch (control & 0x8FU) {
      case 0x06:
        status_[node] = 0x0221;
        break;
      case 0x07:
        status_[node] = 0x0223;
        break;
      case 0x0F:
        status_[node] = 0x0627 | (control & 0x10U) << 8U;
        break;
      default:
        status_[node] = 0x0240;
        break;
    }
  }

  std::optional<CanFrame> reply_;
  std::array<std::uint32_t, 3> status_ = {0x0240, 0x0240, 0x0240};
  std::array<std::uint32_t, 3> mode_{};
};

void require(bool promise) {
  if (!promise) {
    __builtin_trap();
  }
}

}  // namespace

// Whatever frames come, before and after two drives were started up, positions are finite and where they are
// said to be, and the driver asks for no more than a frame can carry.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kStartUpMax = 400;  // milliseconds
  if (size == 0) {
    return 0;
  }
  DrivesLink link({data + 1, size - 1});
  CanopenConfig config;
  config.homing = CanopenHoming::Never;
  const auto driver = CanopenPanTilt::create(config, link);
  const bool starts_up = (data[0] & 1U) != 0;
  for (int i = 0; starts_up && i < kStartUpMax && (*driver)->state() != DeviceState::Ready; ++i) {
    link.pass_quietly();
    (*driver)->step(link.now());
  }
  link.answers = (data[0] & 2U) != 0;
  while (!link.is_over()) {
    link.pass_a_millisecond();
    if ((*driver)->state() == DeviceState::Ready) {
      static_cast<void>((*driver)->move(Axis::Pan, 0.1, 0.5));
    }
    (*driver)->step(link.now());
    std::array<AxisSample, 16> samples;
    const std::size_t count = (*driver)->take(samples);
    for (std::size_t i = 0; i < count; ++i) {
      require(std::isfinite(samples[i].position_rad) && samples[i].stamp <= link.now());
      require(samples[i].half_width >= Stamp{});
    }
    require((*driver)->state() == DeviceState::Ready || !(*driver)->problem().empty());
  }
  return 0;
}
