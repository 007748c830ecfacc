#include "tools/input/pcd_values.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

namespace slamsensor::tools {
namespace {

static_assert(std::endian::native == std::endian::little, "PCD files are little-endian and read as they are");

template <typename T>
double load(std::string_view bytes) {
  T value{};
  std::memcpy(&value, bytes.data(), sizeof value);
  return static_cast<double>(value);
}

double load_signed(std::string_view bytes) {
  switch (bytes.size()) {
    case 1:
      return load<std::int8_t>(bytes);
    case 2:
      return load<std::int16_t>(bytes);
    case 4:
      return load<std::int32_t>(bytes);
    default:
      return load<std::int64_t>(bytes);
  }
}

double load_unsigned(std::string_view bytes) {
  switch (bytes.size()) {
    case 1:
      return load<std::uint8_t>(bytes);
    case 2:
      return load<std::uint16_t>(bytes);
    case 4:
      return load<std::uint32_t>(bytes);
    default:
      return load<std::uint64_t>(bytes);
  }
}

}  // namespace

double PcdColumn::value(std::size_t i) const {
  const std::size_t at = first_bytes + i * step_bytes;
  if (at > bytes.size() || size_bytes > bytes.size() - at) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const std::string_view one = bytes.substr(at, size_bytes);
  switch (type) {
    case PcdType::Signed:
      return load_signed(one);
    case PcdType::Unsigned:
      return load_unsigned(one);
    case PcdType::Float:
      break;
  }
  return size_bytes == sizeof(float) ? load<float>(one) : load<double>(one);
}

PcdColumn column_of_points(std::string_view bytes, const PcdField& field, std::size_t stride_bytes) {
  return {bytes, field.offset_bytes, stride_bytes, field.type, field.size_bytes};
}

PcdColumn column_of_fields(std::string_view bytes, const PcdField& field, std::size_t first_bytes) {
  return {bytes, first_bytes, field.total_bytes(), field.type, field.size_bytes};
}

}  // namespace slamsensor::tools
