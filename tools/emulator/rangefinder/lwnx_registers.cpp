#include "tools/emulator/rangefinder/lwnx_registers.hpp"

#include "tools/emulator/rangefinder/lwnx_packet.hpp"

#include <algorithm>

namespace slamsensor::tools {

LwnxRegisters::LwnxRegisters(const LwnxProduct& product) : product_(product) {
  for (const LwnxRegister& each : product.registers) {
    append_little_endian(each.initial, each.read_bytes, now_[each.id]);
  }
  save_all();
}

std::span<const std::uint8_t> LwnxRegisters::bytes(std::uint8_t id) const {
  return now_[id];
}

std::uint64_t LwnxRegisters::value(std::uint8_t id) const {
  return little_endian(now_[id]);
}

std::int32_t LwnxRegisters::signed_value(std::uint8_t id) const {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(value(id)));
}

void LwnxRegisters::set(std::uint8_t id, std::span<const std::uint8_t> bytes) {
  const std::size_t width = now_[id].size();
  now_[id].assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(width, bytes.size())));
  now_[id].resize(width);
}

void LwnxRegisters::set(std::uint8_t id, std::uint64_t value) {
  std::vector<std::uint8_t> bytes;
  append_little_endian(static_cast<std::int64_t>(value), now_[id].size(), bytes);
  now_[id] = bytes;
}

void LwnxRegisters::set_text(std::uint8_t id, std::string_view text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  set(id, bytes);
}

void LwnxRegisters::save() {
  for (const LwnxRegister& each : product_.registers) {
    if (each.keeps == LwnxRegister::Keeps::WhenSaved) {
      save(each.id);
    }
  }
}

void LwnxRegisters::save(std::uint8_t id) {
  saved_[id] = now_[id];
}

}  // namespace slamsensor::tools
