#include "tools/emulator/canopen/emulated_node.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

bool is_signed(ObjectType type) noexcept {
  return type == ObjectType::I8 || type == ObjectType::I16 || type == ObjectType::I32;
}

}  // namespace

std::uint8_t width_of(ObjectType type) noexcept {
  switch (type) {
    case ObjectType::U8:
    case ObjectType::I8:
      return 1;
    case ObjectType::U16:
    case ObjectType::I16:
      return 2;
    case ObjectType::U32:
    case ObjectType::I32:
      return 4;
    case ObjectType::Text:
      break;
  }
  return 0;
}

std::int64_t number_from(ObjectType type, std::span<const std::uint8_t> bytes) noexcept {
  const std::size_t width = width_of(type);
  std::int64_t value = 0;
  for (std::size_t i = 0; i < width && i < bytes.size(); ++i) {
    value += std::int64_t{bytes[i]} << (8U * i);
  }
  const std::int64_t turn = std::int64_t{1} << (8U * width);
  return is_signed(type) && value >= turn / 2 ? value - turn : value;
}

void append_number(std::vector<std::uint8_t>& bytes, std::int64_t value, std::uint8_t width) {
  for (std::uint8_t i = 0; i < width; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8U * i)));
  }
}

const CanObject* ObjectDictionary::find(ObjectKey key) const {
  const auto found = objects_.find(key);
  return found == objects_.end() ? nullptr : &found->second;
}

SdoAbort ObjectDictionary::missing(ObjectKey key) const {
  const auto next = objects_.lower_bound({key.index, 0});
  const bool has_index = next != objects_.end() && next->first.index == key.index;
  return has_index ? SdoAbort::NoSubIndex : SdoAbort::NoObject;
}

SdoAbort ObjectDictionary::check_write(ObjectKey key, std::span<const std::uint8_t> bytes) const {
  const CanObject* const object = find(key);
  if (object == nullptr) {
    return missing(key);
  }
  if (object->access == ObjectAccess::ReadOnly) {
    return SdoAbort::ReadOnly;
  }
  if (bytes.size() != width_of(object->type)) {
    return bytes.size() > width_of(object->type) ? SdoAbort::TooLong : SdoAbort::TooShort;
  }
  const std::int64_t value = number_from(object->type, bytes);
  if (value > object->high) {
    return SdoAbort::ValueTooHigh;
  }
  return value < object->low ? SdoAbort::ValueTooLow : SdoAbort::None;
}

void ObjectDictionary::restore(const ObjectDictionary& defaults, std::uint16_t first, std::uint16_t last) {
  for (auto& [key, object] : objects_) {
    if (key.index >= first && key.index <= last) {
      object.value = defaults.value(key);
    }
  }
}

namespace {

constexpr std::size_t kSegment = 7;
constexpr std::size_t kDownloadMax = 64;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSized = 0x01;

ObjectKey key_of(const SdoBytes& request) noexcept {
  return {static_cast<std::uint16_t>(request[1] + 256 * request[2]), request[3]};
}

SdoBytes reply(std::uint8_t command, ObjectKey key, std::span<const std::uint8_t> data) noexcept {
  SdoBytes bytes{command, static_cast<std::uint8_t>(key.index), static_cast<std::uint8_t>(key.index >> 8U),
                 key.sub};
  std::copy_n(data.begin(), std::min<std::size_t>(data.size(), 4), bytes.begin() + 4);
  return bytes;
}

SdoBytes abort_reply(ObjectKey key, SdoAbort code) {
  std::vector<std::uint8_t> data;
  append_number(data, static_cast<std::int64_t>(code), 4);
  return reply(0x80, key, data);
}

}  // namespace

bool SdoServer::order(FaultKind kind) {
  aborts_ += kind == FaultKind::SdoAbort ? 1U : 0U;
  silences_ += kind == FaultKind::SdoSilence ? 1U : 0U;
  return kind == FaultKind::SdoAbort || kind == FaultKind::SdoSilence;
}

std::optional<SdoBytes> SdoServer::answer(const SdoBytes& request) {
  if (silences_ > 0) {
    --silences_;
    return std::nullopt;
  }
  if (aborts_ > 0) {
    --aborts_;
    return abort(request, SdoAbort::General);
  }
  return serve(request);
}

std::optional<SdoBytes> SdoServer::serve(const SdoBytes& request) {
  switch (request[0] >> 5U) {
    case 0:
      return download_segment(request);
    case 1:
      return begin_download(request);
    case 2:
      return begin_upload(request);
    case 3:
      return upload_segment(request);
    case 4:
      reset();
      return std::nullopt;
    default:
      return abort(request, SdoAbort::BadCommand);
  }
}

SdoBytes SdoServer::abort(const SdoBytes& request, SdoAbort code) {
  reset();
  return abort_reply(key_of(request), code);
}

SdoBytes SdoServer::give_up(SdoAbort code) {
  reset();
  return abort_reply(key_, code);
}

SdoBytes SdoServer::begin_download(const SdoBytes& request) {
  key_ = key_of(request);
  bytes_.clear();
  toggle_ = 0;
  if ((request[0] & kExpedited) == 0) {
    transfer_ = Transfer::Download;
    return reply(0x60, key_, {});
  }
  reset();
  // Without a length it is as long as the object.
  const std::size_t size =
      (request[0] & kSized) != 0 ? 4U - ((request[0] >> 2U) & 3U) : keeper_.object_width(key_);
  const SdoAbort code =
      keeper_.write_object(key_, std::span(request).subspan(4, std::min<std::size_t>(size, 4)));
  return code == SdoAbort::None ? reply(0x60, key_, {}) : abort_reply(key_, code);
}

SdoBytes SdoServer::download_segment(const SdoBytes& request) {
  if (transfer_ != Transfer::Download) {
    return abort(request, SdoAbort::BadCommand);
  }
  if ((request[0] & kToggle) != toggle_) {
    return give_up(SdoAbort::Toggle);
  }
  const std::size_t size = kSegment - ((request[0] >> 1U) & 7U);
  bytes_.insert(bytes_.end(), request.begin() + 1, request.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if (bytes_.size() > kDownloadMax) {
    return give_up(SdoAbort::TooLong);
  }
  if ((request[0] & 1U) != 0) {
    reset();
    if (const SdoAbort code = keeper_.write_object(key_, bytes_); code != SdoAbort::None) {
      return give_up(code);
    }
  }
  SdoBytes bytes{static_cast<std::uint8_t>(0x20U | toggle_)};
  toggle_ ^= kToggle;
  return bytes;
}

SdoBytes SdoServer::begin_upload(const SdoBytes& request) {
  key_ = key_of(request);
  bytes_.clear();
  reset();
  if (const SdoAbort code = keeper_.read_object(key_, bytes_); code != SdoAbort::None) {
    return abort_reply(key_, code);
  }
  if (bytes_.size() <= 4) {
    const std::size_t unused = 4 - bytes_.size();
    return reply(static_cast<std::uint8_t>(0x43U | (unused << 2U)), key_, bytes_);
  }
  transfer_ = Transfer::Upload;
  sent_ = 0;
  toggle_ = 0;
  std::vector<std::uint8_t> size;
  append_number(size, static_cast<std::int64_t>(bytes_.size()), 4);
  return reply(0x41, key_, size);
}

SdoBytes SdoServer::upload_segment(const SdoBytes& request) {
  if (transfer_ != Transfer::Upload) {
    return abort(request, SdoAbort::BadCommand);
  }
  if ((request[0] & kToggle) != toggle_) {
    return give_up(SdoAbort::Toggle);
  }
  const std::size_t size = std::min(kSegment, bytes_.size() - sent_);
  SdoBytes bytes{};
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(sent_), size, bytes.begin() + 1);
  sent_ += size;
  const bool is_last = sent_ == bytes_.size();
  bytes[0] = static_cast<std::uint8_t>(toggle_ | ((kSegment - size) << 1U) | (is_last ? 1U : 0U));
  toggle_ ^= kToggle;
  if (is_last) {
    reset();
  }
  return bytes;
}

hal::CanFrame node_frame(std::uint32_t id, std::span<const std::uint8_t> bytes) noexcept {
  hal::CanFrame frame{.id = id, .extended = false, .size = static_cast<std::uint8_t>(bytes.size())};
  std::ranges::copy(bytes, frame.data.begin());
  return frame;
}

std::vector<std::uint8_t> emergency_bytes(std::uint16_t code, std::uint8_t error_register) {
  std::vector<std::uint8_t> bytes;
  append_number(bytes, code, 2);
  bytes.push_back(error_register);
  bytes.resize(8);
  return bytes;
}

}  // namespace slamsensor::tools
