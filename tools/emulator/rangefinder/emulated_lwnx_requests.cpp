#include "tools/emulator/rangefinder/emulated_lwnx.hpp"
#include "tools/world/random.hpp"

namespace slamsensor::tools {
namespace {

constexpr std::uint8_t kTokenId = 10;
constexpr std::uint8_t kSaveId = 12;
constexpr std::uint8_t kResetId = 14;
constexpr std::uint8_t kStageFirmwareId = 16;
constexpr std::uint8_t kCommitFirmwareId = 17;
constexpr std::uint8_t kStreamId = 30;
constexpr std::uint8_t kStatisticsId = 31;
constexpr std::uint8_t kRawId = 40;
constexpr std::uint8_t kCmId = 44;
constexpr std::uint8_t kMmId = 45;
constexpr std::int32_t kFirmwareOfAnother = -7;
constexpr std::int32_t kFirmwareCheckFailed = -1;
constexpr Stamp kStatisticsPeriod = std::chrono::milliseconds(500);

std::uint64_t as_word(std::int32_t value) {
  return static_cast<std::uint32_t>(value);
}

}  // namespace

void EmulatedLwnx::receive(std::uint8_t byte, Stamp at) {
  if (!machine_.power.is_up()) {
    return;
  }
  if (const auto request = receiver_.push(byte, at)) {
    text_.clear();
    take_request(*request, at);
  } else if (!receiver_.in_packet() && !is_lwnx_) {
    take_text(byte, at);
  }
}

void EmulatedLwnx::take_request(const LwnxRequest& request, Stamp at) {
  if (unanswered_first_ > 0) {
    --unanswered_first_;
    return;
  }
  enter_lwnx(at);
  if (unanswered_packets_ > 0) {
    --unanswered_packets_;
    return;
  }
  const LwnxRegister* const command = product_.find(request.id);
  if (command == nullptr) {
    ++refused_;
  } else if (request.access == LwnxAccess::Write) {
    answer_write(*command, request, at);
  } else if (command->read_bytes > 0 && request.data.empty()) {
    answer_read(*command, at);
  } else {
    ++refused_;
  }
}

void EmulatedLwnx::enter_lwnx(Stamp at) {
  if (is_lwnx_) {
    return;
  }
  is_lwnx_ = true;
  text_stream_.reset();
  retime(at);
}

void EmulatedLwnx::answer_read(const LwnxRegister& command, Stamp at) {
  if (command.id == kCmId || command.id == kMmId || command.id == kRawId) {
    answer_distance(command.id, at);
    return;
  }
  if (command.id == kTokenId) {
    registers_.set(kTokenId, std::uint64_t{token_});
  }
  const auto bytes = registers_.bytes(command.id);
  data_.assign(bytes.begin(), bytes.end());
  put_packet(command.id, LwnxAccess::Read, at);
}

void EmulatedLwnx::answer_distance(std::uint8_t id, Stamp at) {
  const LwnxReading reading = measure(at);
  data_.clear();
  const std::uint64_t bits = registers_.value(product_.ids.distance_output);
  if (id == kCmId) {
    pack_cm(product_, bits, reading, reader_.recent(reading), data_);
  } else if (id == kMmId) {
    pack_mm(product_, bits, reading, reader_.recent(reading), data_);
  } else {
    data_.push_back(1);
    append_little_endian(distance_word(reading, reading.range_m, {100.0, 2, product_.no_return}), 2, data_);
  }
  build_packet(id, LwnxAccess::Read, data_, packet_);
  machine_.outbox.put_answer(packet_, at, {&at, 1});
}

void EmulatedLwnx::answer_write(const LwnxRegister& command, const LwnxRequest& request, Stamp at) {
  if (!command.write_bytes || *command.write_bytes != request.data.size() || !write(request, at)) {
    ++refused_;
    return;
  }
  data_.clear();
  if (settings_.write_answer == LwnxWriteAnswer::Value) {
    const auto kept = registers_.bytes(command.id);
    data_.assign(kept.begin(), kept.end());  // save and reset have none
  }
  put_packet(command.id, settings_.write_answer_flag, at);
}

bool EmulatedLwnx::write(const LwnxRequest& request, Stamp at) {
  const std::uint64_t value = little_endian(request.data);
  const LwnxIds& ids = product_.ids;
  if (request.id == ids.update_rate) {
    if (product_.rate_hz(value)) {
      registers_.set(request.id, request.data);
      retime(at);
    }
  } else if (request.id == ids.baud) {
    if (lwnx_baud(value)) {
      registers_.set(request.id, request.data);  // the line keeps its rate until the next start
    }
  } else if (request.id == ids.lost_counter) {
    if (value >= product_.lost_counter_min) {
      registers_.set(request.id, request.data);
    }
  } else if (request.id == ids.high_speed) {
    registers_.set(request.id, value & 1U);
    retime(at);
  } else {
    return write_common(request, at);
  }
  return true;
}

bool EmulatedLwnx::write_common(const LwnxRequest& request, Stamp at) {
  const std::uint64_t value = little_endian(request.data);
  switch (request.id) {
    case kSaveId:
      if (!use_token(request)) {
        return false;
      }
      registers_.save();
      return true;
    case kResetId:
      if (!use_token(request)) {
        return false;
      }
      machine_.restart_at = at + settings_.restart_delay;
      return true;
    case kStageFirmwareId:
      registers_.set(request.id, as_word(kFirmwareOfAnother));
      return true;
    case kCommitFirmwareId:
      registers_.set(request.id, as_word(kFirmwareCheckFailed));
      return true;
    case kStreamId:
      if (product_.stream(static_cast<std::uint32_t>(value))) {
        registers_.set(request.id, request.data);
        retime(at);
      }
      return true;
    case kStatisticsId:
      registers_.set(request.id, value & 1U);
      statistics_at_ = (value & 1U) != 0 ? at + kStatisticsPeriod : hal::kNever;
      return true;
    default:
      registers_.set(request.id, request.data);
      return true;
  }
}

bool EmulatedLwnx::use_token(const LwnxRequest& request) {
  if (little_endian(request.data) != token_) {
    return false;
  }
  ++tokens_;
  token_ = static_cast<std::uint16_t>(mix_seed(settings_.seed, tokens_));
  return true;
}

void EmulatedLwnx::put_packet(std::uint8_t id, LwnxAccess access, Stamp at) {
  build_packet(id, access, data_, packet_);
  machine_.outbox.put_answer(packet_, at);
}

}  // namespace slamsensor::tools
