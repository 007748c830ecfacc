#include "tools/emulator/canopen/object_dictionary.hpp"

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

}  // namespace slamsensor::tools
