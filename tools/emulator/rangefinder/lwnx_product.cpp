#include "tools/emulator/rangefinder/lwnx_product.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::uint8_t kStart = 0xAA;
constexpr std::size_t kHeaderBytes = 3;
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kPayloadMax = 160;  // the longest request is a page of firmware: 131
constexpr hal::Stamp kPause = std::chrono::milliseconds(100);

}  // namespace

void append_little_endian(std::int64_t value, std::size_t bytes, std::vector<std::uint8_t>& data) {
  auto bits = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < bytes; ++i) {
    data.push_back(static_cast<std::uint8_t>(bits & 0xFFU));
    bits >>= 8U;
  }
}

std::uint64_t little_endian(std::span<const std::uint8_t> data) {
  std::uint64_t value = 0;
  for (std::size_t i = std::min<std::size_t>(data.size(), 8); i > 0; --i) {
    value = value << 8U | data[i - 1];
  }
  return value;
}

void build_packet(std::uint8_t id, RequestAccess access, std::span<const std::uint8_t> data,
                  std::vector<std::uint8_t>& packet) {
  const auto length = static_cast<std::int64_t>(data.size() + 1);
  packet.clear();
  packet.push_back(kStart);
  append_little_endian(length * 64 + (access == RequestAccess::Write ? 1 : 0), 2, packet);
  packet.push_back(id);
  packet.insert(packet.end(), data.begin(), data.end());
  append_little_endian(crc16_xmodem(packet), kCrcBytes, packet);
}

std::optional<LwnxRequest> LwnxReceiver::push(std::uint8_t byte, hal::Stamp at) {
  if (at - last_byte_ > kPause) {
    buffer_.clear();
  }
  last_byte_ = at;
  if (buffer_.empty() && byte != kStart) {
    return std::nullopt;
  }
  buffer_.push_back(byte);
  return take_request();
}

std::optional<LwnxRequest> LwnxReceiver::take_request() {
  while (buffer_.size() >= kHeaderBytes) {
    const std::size_t whole = packet_bytes();
    if (whole != 0 && buffer_.size() < whole) {
      return std::nullopt;
    }
    const std::span<const std::uint8_t> packet(buffer_.data(), whole);
    if (whole == 0 ||
        crc16_xmodem(packet.first(whole - kCrcBytes)) != little_endian(packet.last(kCrcBytes))) {
      ++refused_;
      skip_false_start();
      continue;
    }
    LwnxRequest request;
    request.id = packet[kHeaderBytes];
    request.access = (packet[1] & 1U) != 0 ? RequestAccess::Write : RequestAccess::Read;
    request.data.assign(packet.begin() + kHeaderBytes + 1, packet.end() - kCrcBytes);
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(whole));
    return request;
  }
  return std::nullopt;
}

std::size_t LwnxReceiver::packet_bytes() const {
  const std::size_t payload = static_cast<std::size_t>(buffer_[2]) * 4 + buffer_[1] / 64U;
  return payload == 0 || payload > kPayloadMax ? 0 : kHeaderBytes + payload + kCrcBytes;
}

void LwnxReceiver::skip_false_start() {
  buffer_.erase(buffer_.begin(), std::find(buffer_.begin() + 1, buffer_.end(), kStart));
}

namespace {

constexpr auto kSaved = LwnxRegister::Keeps::WhenSaved;
constexpr auto kLost = LwnxRegister::Keeps::No;
constexpr std::array<std::uint32_t, 8> kBauds = {9600,   19'200,  38'400,  57'600,
                                                 115200, 230'400, 460'800, 921'600};

void add(LightWareProduct& product, const std::vector<LwnxRegister>& registers) {
  product.registers.insert(product.registers.end(), registers.begin(), registers.end());
}

std::int64_t baud_value(const LightWareProduct& product) {
  return lwnx_baud_value(product.baud).value_or(4);
}

/// What every product has: name, token, save, reset, stream, data, laser.
void add_common(LightWareProduct& product) {
  add(product,
      {{0, 16, {}}, {10, 2, {}}, {12, 0, 2}, {14, 0, 2}, {30, 4, 4}, {44, 1, {}}, {50, 1, 1, kLost, 1}});
}

/// LW20 manual, revision 10. SF20 is the same device.
LightWareProduct lw20(const char* name) {
  LightWareProduct product;
  product.name = name;
  product.ids = {27, 93, 70, 95, 90};
  product.unanswered_first = 1;
  product.unanswered_packets = 1;
  product.rates_hz = {48, 55, 64, 77, 97, 129, 194, 388};
  using enum LwnxField;
  product.fields = {Raw, Filtered, Filtered, Filtered, Strength, Raw, Filtered, Filtered, Filtered, Strength};
  product.streams = {{0, LwnxStream::Off}, {1, LwnxStream::Raw}, {5, LwnxStream::Cm}};
  add_common(product);
  add(product, {{27, 4, 4, kLost, 0x11},
                {28, 1, 1, kSaved},
                {40, 1, {}},
                {70, 1, 1},
                {90, 1, 1, kSaved, 4},
                {93, 1, 1, kSaved, 8},
                {95, 4, 4, kSaved, 1}});
  return product;
}

/// LW24 guide of 2022, SF000 guide revision 5, LightWare's samples, the PX4 driver of the SF45/B.
LightWareProduct sf_family(const char* name) {
  LightWareProduct product;
  product.name = name;
  // Not published; as far as the codes of the LW20 go they are taken to mean the same.
  product.rates_hz = {48, 55, 64, 77, 97, 129, 194, 388, 625, 1250, 2500, 5000};
  using enum LwnxField;
  product.fields = {Raw, Filtered, Strength, Raw, Filtered, Strength};
  product.streams = {{0, LwnxStream::Off}, {5, LwnxStream::Cm}, {6, LwnxStream::Mm}};
  add_common(product);
  add(product, {{27, 4, 4, kSaved, 0x05}, {45, 1, {}}, {66, 1, 1, kSaved, 8}, {76, 4, 4, kSaved, 1}});
  return product;
}

/// Nothing is published of its LWNX commands: its outputs are taken to be those of the LW20.
LightWareProduct sf11() {
  LightWareProduct product = sf_family("SF11");
  product.fields = lw20("SF11").fields;
  product.unanswered_packets = 1;  // its sample sends one to switch LWNX on
  product.rates_hz = {20};
  product.find(66)->initial = 1;
  product.streams = {{0, LwnxStream::Off}, {5, LwnxStream::Cm}};
  return product;
}

LightWareProduct sf45b() {
  LightWareProduct product = sf_family("SF45");
  product.baud = 921600;
  product.rates_hz = {50, 100, 200, 400, 500, 625, 1000, 1250, 1538, 2000, 2500, 5000};
  product.find(66)->initial = 1;
  return product;
}

/// SF30/D samples: distance output 29, update rate 76 (value 8 is 78 readings per second).
LightWareProduct sf30d() {
  LightWareProduct product = sf_family("SF30/D");
  product.baud = 921600;
  product.ids = {29, 76, 255, 78, 91};
  product.first_rate_value = 0;
  product.rates_hz.clear();
  constexpr double kFull_hz = 20'010.0;
  for (unsigned halvings = 0; halvings < 10; ++halvings) {
    product.rates_hz.push_back(kFull_hz / static_cast<double>(1U << halvings));
  }
  product.streams = {{0, LwnxStream::Off}, {5, LwnxStream::Cm}, {6, LwnxStream::Mm}, {11, LwnxStream::Raw}};
  product.registers.clear();
  add_common(product);
  add(product,
      {{29, 4, 4, kLost, 0x05}, {40, 1, {}}, {45, 1, {}}, {76, 1, 1, kSaved, 4}, {78, 4, 4, kSaved, 1}});
  return product;
}

/// LightWare's grf-500-api, 1.1.0.
LightWareProduct grf500() {
  LightWareProduct product;
  product.name = "GRF-500";
  product.ids = {27, 74, 255, 78, 91};
  using enum LwnxField;
  product.fields = {Raw, Filtered, Strength, Raw, Filtered, Strength};
  product.cm_field_bytes = 4;
  product.cm_units_per_m = 10.0;
  product.no_return = -10;
  product.lost_counter_min = 1;
  product.streams = {{0, LwnxStream::Off}, {5, LwnxStream::Cm}};
  add_common(product);
  add(product, {{27, 4, 4, kSaved, 0x07}, {74, 4, 4, kSaved, 50}, {78, 4, 4, kSaved, 1}});
  return product;
}

LightWareProduct make(LwnxModel model) {
  switch (model) {
    case LwnxModel::Lw20:
      return lw20("LW20");
    case LwnxModel::Sf20:
      return lw20("SF20");
    case LwnxModel::Lw24:
      return sf_family("LW24");
    case LwnxModel::Sf000:
      return sf_family("SF000");
    case LwnxModel::Sf11:
      return sf11();
    case LwnxModel::Sf30d:
      return sf30d();
    case LwnxModel::Sf45b:
      return sf45b();
    case LwnxModel::Grf500:
      return grf500();
  }
  return lw20("LW20");
}

}  // namespace

const LwnxRegister* LightWareProduct::find(std::uint8_t id) const {
  const auto found = std::ranges::find(registers, id, &LwnxRegister::id);
  return found != registers.end() ? &*found : nullptr;
}

LwnxRegister* LightWareProduct::find(std::uint8_t id) {
  return const_cast<LwnxRegister*>(std::as_const(*this).find(id));
}

std::optional<LwnxStream> LightWareProduct::stream(std::uint32_t value) const {
  const auto found = std::ranges::find(streams, value, &std::pair<std::uint32_t, LwnxStream>::first);
  return found != streams.end() ? std::optional(found->second) : std::nullopt;
}

std::optional<double> LightWareProduct::rate_hz(std::uint64_t value) const {
  if (rates_hz.empty()) {
    constexpr std::uint64_t kTenthsMin = 5;
    constexpr std::uint64_t kTenthsMax = 100;
    return value >= kTenthsMin && value <= kTenthsMax ? std::optional(static_cast<double>(value) / 10.0)
                                                      : std::nullopt;
  }
  const bool known = value >= first_rate_value && value - first_rate_value < rates_hz.size();
  return known ? std::optional(rates_hz[value - first_rate_value]) : std::nullopt;
}

LightWareProduct lwnx_product(LwnxModel model) {
  LightWareProduct product = make(model);
  if (product.find(product.ids.baud) == nullptr) {
    add(product, {{product.ids.baud, 1, 1, kSaved, baud_value(product)}});
  }
  return product;
}

std::optional<std::uint32_t> lwnx_baud(std::uint64_t value) {
  return value < kBauds.size() ? std::optional(kBauds[value]) : std::nullopt;
}

std::optional<std::uint8_t> lwnx_baud_value(std::uint32_t baud) {
  const auto found = std::ranges::find(kBauds, baud);
  return found != kBauds.end() ? std::optional(static_cast<std::uint8_t>(found - kBauds.begin()))
                               : std::nullopt;
}

LwnxRegisters::LwnxRegisters(const LightWareProduct& product) : product_(product) {
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
