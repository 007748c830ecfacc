#include "tools/recording/tape_reader.hpp"

#include <algorithm>
#include <limits>

namespace slamsensor::tools {
namespace {

using firmware::TapeOp;

constexpr std::uint64_t kNumberMax = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kNumber32Max = std::numeric_limits<std::uint32_t>::max();

// Times stay far from where their sums overflow: 73 years since boot.
constexpr std::int64_t kTimeMax_ns = std::int64_t{1} << 61;

constexpr bool is_time(std::int64_t ns) noexcept {
  return ns >= -kTimeMax_ns && ns <= kTimeMax_ns;
}

}  // namespace

void TapeReader::load(std::span<const std::uint8_t> chunk) noexcept {
  rest_ = chunk;
  is_first_step_ = true;
  is_broken_ = false;
}

std::optional<std::uint64_t> TapeReader::number(std::uint64_t max) noexcept {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    const std::uint64_t bits = byte & 0x7FU;
    if (shift == 63 && bits > 1) {
      return std::nullopt;
    }
    value |= bits << shift;
    if (byte < 0x80U) {
      return value <= max ? std::optional(value) : std::nullopt;
    }
  }
  return std::nullopt;
}

std::optional<std::int64_t> TapeReader::signed_number() noexcept {
  const auto value = number(kNumberMax);
  if (!value) {
    return std::nullopt;
  }
  return static_cast<std::int64_t>((*value >> 1U) ^ (~(*value & 1U) + 1U));
}

std::optional<TapeOperation> TapeReader::next() noexcept {
  if (rest_.empty() || is_broken_) {
    return std::nullopt;
  }
  const unsigned head = rest_.front();
  rest_ = rest_.subspan(1);
  TapeOperation operation;
  operation.op = static_cast<TapeOp>(head >> 4U);
  operation.link = static_cast<firmware::HeadLink>(head & 0xFU);
  const bool is_known = (head >> 4U) < firmware::kTapeOps && (head & 0xFU) < firmware::kHeadLinkNames.size();
  const Operation result = is_known ? fields(operation) : std::nullopt;
  is_broken_ = !result;
  return result;
}

std::optional<TapeOperation> TapeReader::fields(TapeOperation operation) noexcept {
  const auto when = [&operation](bool is_good) { return is_good ? Operation(operation) : std::nullopt; };
  switch (operation.op) {
    case TapeOp::Open:
    case TapeOp::Service:
    case TapeOp::After:
      return take_state(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::Step:
      return step(operation);
    case TapeOp::ReadBusy:
    case TapeOp::ReadDown:
    case TapeOp::Discard:
    case TapeOp::End:
      return operation;
    case TapeOp::ReadOk:
      operation.status = hal::LinkStatus::Ok;
      return take_stamp(operation) && take_bytes(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::Write:
      return take_status(operation) && take_bytes(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::SetBaud: {
      const bool has_status = take_status(operation);
      const auto baud = number(kNumber32Max);
      operation.baud = static_cast<std::uint32_t>(baud.value_or(0));
      return when(has_status && baud);
    }
    case TapeOp::CanReceive:
      operation.status = hal::LinkStatus::Ok;
      return take_stamp(operation) && take_frame(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::CanSend:
      return take_status(operation) && take_frame(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::Command:
      return take_command(operation) ? Operation(operation) : std::nullopt;
    case TapeOp::Lost: {
      const auto lost = number(kNumberMax);
      operation.number = lost.value_or(0);
      return when(lost.has_value());
    }
  }
  return std::nullopt;
}

std::optional<TapeOperation> TapeReader::step(TapeOperation operation) noexcept {
  std::optional<std::int64_t> change;
  if (is_first_step_) {
    const auto now = number(static_cast<std::uint64_t>(kTimeMax_ns));
    change = now ? std::optional(static_cast<std::int64_t>(*now) - (now_ + period_).count()) : std::nullopt;
  } else {
    change = signed_number();
  }
  if (!change || !is_time(*change)) {
    return std::nullopt;
  }
  const std::int64_t period_ns = period_.count() + *change;
  if (period_ns < 0 || !is_time(period_ns) || !is_time(now_.count() + period_ns)) {
    return std::nullopt;
  }
  period_ = hal::Stamp(period_ns);
  now_ += period_;
  is_first_step_ = false;
  operation.time = now_;
  return operation;
}

bool TapeReader::take_state(TapeOperation& operation) noexcept {
  const auto epoch = number(kNumber32Max);
  const auto is_up = number(1);
  const auto baud = number(kNumber32Max);
  if (!epoch || !is_up || !baud) {
    return false;
  }
  operation.state = {static_cast<std::uint32_t>(*epoch), *is_up == 1, static_cast<std::uint32_t>(*baud)};
  return true;
}

bool TapeReader::take_stamp(TapeOperation& operation) noexcept {
  const auto offset = signed_number();
  if (!offset || !is_time(*offset)) {
    return false;
  }
  operation.time = now_ + hal::Stamp(*offset);
  return true;
}

bool TapeReader::take_status(TapeOperation& operation) noexcept {
  const auto status = number(static_cast<std::uint64_t>(hal::LinkStatus::Down));
  operation.status = static_cast<hal::LinkStatus>(status.value_or(0));
  return status.has_value();
}

bool TapeReader::take_bytes(TapeOperation& operation) noexcept {
  const auto count = number(std::min<std::uint64_t>(firmware::kTapeBytesMax, rest_.size()));
  if (!count || *count > rest_.size()) {
    return false;
  }
  operation.bytes = rest_.first(static_cast<std::size_t>(*count));
  rest_ = rest_.subspan(operation.bytes.size());
  return true;
}

bool TapeReader::take_frame(TapeOperation& operation) noexcept {
  const auto id = number(kNumber32Max);
  const auto shape = number(2 * operation.frame.data.size() + 1);
  if (!id || !shape || *shape / 2 > rest_.size()) {
    return false;
  }
  operation.frame.id = static_cast<std::uint32_t>(*id);
  operation.frame.extended = *shape % 2 == 1;
  operation.frame.size = static_cast<std::uint8_t>(*shape / 2);
  std::copy_n(rest_.begin(), operation.frame.size, operation.frame.data.begin());
  rest_ = rest_.subspan(operation.frame.size);
  return true;
}

bool TapeReader::take_command(TapeOperation& operation) noexcept {
  const auto command = number(firmware::kTapeCommands - 1);
  const auto argument = number(kNumberMax);
  operation.command = static_cast<firmware::TapeCommand>(command.value_or(0));
  operation.number = argument.value_or(0);
  return command && argument;
}

}  // namespace slamsensor::tools
