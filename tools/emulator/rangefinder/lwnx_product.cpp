#include "tools/emulator/rangefinder/lwnx_product.hpp"

#include <algorithm>
#include <array>

namespace slamsensor::tools {
namespace {

constexpr auto kSaved = LwnxRegister::Keeps::WhenSaved;
constexpr auto kLost = LwnxRegister::Keeps::No;
constexpr std::array<std::uint32_t, 8> kBauds = {9600,   19'200,  38'400,  57'600,
                                                 115200, 230'400, 460'800, 921'600};

void add(LwnxProduct& product, const std::vector<LwnxRegister>& registers) {
  product.registers.insert(product.registers.end(), registers.begin(), registers.end());
}

std::int64_t baud_value(const LwnxProduct& product) {
  return lwnx_baud_value(product.baud).value_or(4);
}

/// What every product has: identity, user data, token, save, reset, firmware, stream, data, laser.
void add_common(LwnxProduct& product) {
  add(product, {{0, 16, {}},
                {1, 4, {}, kLost, 11},
                {2, 4, {}, kLost, 0x010604},
                {3, 16, {}},
                {9, 16, 16, kSaved},
                {10, 2, {}},
                {12, 0, 2},
                {14, 0, 2},
                {16, 4, 130},
                {17, 4, 0},
                {30, 4, 4},
                {44, 1, {}},
                {50, 1, 1, kLost, 1}});
}

/// LW20 manual, revision 10. SF20 is the same device.
LwnxProduct lw20(const char* name) {
  LwnxProduct product;
  product.name = name;
  product.text_name = name;
  product.ids = {27, 55, 93, 70, 85, 94, 95, 90};
  product.unanswered_first = 1;
  product.unanswered_packets = 1;
  product.rates_hz = {48, 55, 64, 77, 97, 129, 194, 388};
  using enum LwnxField;
  product.fields = {Raw,     Closest, Median,   Furthest, Strength, Raw,
                    Closest, Median,  Furthest, Strength, Noise};
  product.streams = {
      {0, LwnxStream::Off}, {1, LwnxStream::Raw}, {5, LwnxStream::Cm}, {10, LwnxStream::Ignored}};
  add_common(product);
  add(product, {{20, 4, {}, kLost, 5000},
                {27, 4, 4, kLost, 0x11},
                {28, 1, 1, kSaved},
                {31, 1, 1},
                {40, 1, {}},
                {55, 4, {}, kLost, 2350},
                {70, 1, 1},
                {85, 4, {}, kLost, 12},
                {88, 2, {}},
                {90, 1, 1, kSaved, 4},
                {91, 1, 1, kSaved, 0x66},
                {93, 1, 1, kSaved, 8},
                {94, 4, 4, kSaved},
                {95, 4, 4, kSaved, 1},
                {96, 4, 4, kSaved, 500},
                {97, 4, 4, kSaved, 500},
                {98, 4, 4, kSaved, 10}});
  return product;
}

/// LW24 guide of 2022, SF000 guide revision 5, LightWare's samples, the PX4 driver of the SF45/B.
LwnxProduct sf_family(const char* name) {
  LwnxProduct product;
  product.name = name;
  product.text_name = name;
  // Not published; as far as the codes of the LW20 go they are taken to mean the same.
  product.rates_hz = {48, 55, 64, 77, 97, 129, 194, 388, 625, 1250, 2500, 5000};
  using enum LwnxField;
  product.fields = {Raw, Median, Strength, Raw, Median, Strength, Noise, Temperature};
  product.streams = {
      {0, LwnxStream::Off}, {5, LwnxStream::Cm}, {6, LwnxStream::Mm}, {10, LwnxStream::Ignored}};
  add_common(product);
  add(product, {{27, 4, 4, kSaved, 0x05},
                {45, 1, {}},
                {57, 4, {}, kLost, 2350},
                {66, 1, 1, kSaved, 8},
                {74, 4, {}, kLost, 12},
                {75, 4, 4, kSaved},
                {76, 4, 4, kSaved, 1},
                {80, 1, 1, kSaved, 0x66}});
  return product;
}

/// Nothing is published of its LWNX commands: its outputs are taken to be those of the LW20.
LwnxProduct sf11() {
  LwnxProduct product = sf_family("SF11");
  product.fields = lw20("SF11").fields;
  product.text_name = "SF11/C";
  product.text_style = LwnxTextStyle::Sf11;
  product.unanswered_packets = 1;  // its sample sends one to switch LWNX on
  product.rates_hz = {20};
  product.find(66)->initial = 1;
  product.streams = {{0, LwnxStream::Off}, {1, LwnxStream::Ignored}, {5, LwnxStream::Cm}};
  return product;
}

LwnxProduct sf45b() {
  LwnxProduct product = sf_family("SF45");
  product.baud = 921600;
  product.rates_hz = {50, 100, 200, 400, 500, 625, 1000, 1250, 1538, 2000, 2500, 5000};
  product.fields.push_back(LwnxField::Yaw);
  product.find(66)->initial = 1;
  add(product, {{85, 2, 2, kSaved, 5},
                {93, 1, {}},
                {94, 1, 1, kSaved},
                {96, 1, 1},
                {97, 4, 4},
                {98, 4, 4, kSaved},
                {99, 4, 4, kSaved}});
  return product;
}

/// SF30/D samples: distance output 29, update rate 76 (value 8 is 78 readings per second), return mode 77.
LwnxProduct sf30d() {
  LwnxProduct product = sf_family("SF30/D");
  product.baud = 921600;
  product.ids = {29, 55, 76, 255, 85, 114, 78, 91};
  product.first_rate_value = 0;
  product.rates_hz.clear();
  constexpr double kFull_hz = 20'010.0;
  for (unsigned halvings = 0; halvings < 10; ++halvings) {
    product.rates_hz.push_back(kFull_hz / static_cast<double>(1U << halvings));
  }
  product.streams = {{0, LwnxStream::Off}, {5, LwnxStream::Cm}, {6, LwnxStream::Mm}, {11, LwnxStream::Raw}};
  product.registers.clear();
  add_common(product);
  add(product, {{29, 4, 4, kLost, 0x05},
                {40, 1, {}},
                {45, 1, {}},
                {55, 4, {}, kLost, 2350},
                {76, 1, 1, kSaved, 4},
                {77, 2, 2, kSaved},
                {78, 4, 4, kSaved, 1},
                {85, 4, {}, kLost, 12},
                {92, 1, 1, kSaved, 0x66},
                {114, 4, 4, kSaved}});
  return product;
}

/// LightWare's grf-500-api, 1.1.0.
LwnxProduct grf500() {
  LwnxProduct product;
  product.name = "GRF-500";
  product.text_name = "GRF-500";
  product.ids = {27, 55, 74, 255, 255, 114, 78, 91};
  using enum LwnxField;
  product.fields = {Raw, Median, Strength, Raw, Median, Strength, Temperature, Alarm};
  product.cm_field_bytes = 4;
  product.cm_units_per_m = 10.0;
  product.mm_signals = 5;
  product.no_return = -10;
  product.no_return_mm = -1000;
  product.lost_counter_min = 1;
  product.zero_offset_unit_m = 0.1;
  product.streams = {{0, LwnxStream::Off}, {5, LwnxStream::Cm}, {6, LwnxStream::Mm}};
  add_common(product);
  add(product, {{27, 4, 4, kSaved, 0x07},
                {45, 1, {}},
                {55, 4, {}, kLost, 2350},
                {70, 1, 1, kSaved, 1},
                {74, 4, 4, kSaved, 50},
                {76, 2, {}},
                {77, 1, 1, kSaved},
                {78, 4, 4, kSaved, 1},
                {79, 4, 4, kSaved, 500},
                {80, 4, 4, kSaved, 500},
                {81, 4, 4, kSaved, 10},
                {83, 1, 1, kSaved},
                {84, 4, 4, kSaved},
                {86, 1, 1, kSaved},
                {87, 4, 4, kSaved, 3},
                {88, 1, 1, kSaved},
                {89, 4, 4, kSaved, 50},
                {92, 1, 1, kSaved, 0x66},
                {93, 1, 1, kSaved},
                {94, 4, 4, kSaved, 2},
                {98, 0, 1},
                {110, 1, 1, kSaved, 1},
                {114, 4, 4, kSaved}});
  return product;
}

LwnxProduct make(LwnxModel model) {
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

const LwnxRegister* LwnxProduct::find(std::uint8_t id) const {
  const auto found = std::ranges::find(registers, id, &LwnxRegister::id);
  return found != registers.end() ? &*found : nullptr;
}

LwnxRegister* LwnxProduct::find(std::uint8_t id) {
  return const_cast<LwnxRegister*>(std::as_const(*this).find(id));
}

std::optional<LwnxStream> LwnxProduct::stream(std::uint32_t value) const {
  const auto found = std::ranges::find(streams, value, &std::pair<std::uint32_t, LwnxStream>::first);
  return found != streams.end() ? std::optional(found->second) : std::nullopt;
}

std::optional<double> LwnxProduct::rate_hz(std::uint64_t value) const {
  if (rates_hz.empty()) {
    constexpr std::uint64_t kTenthsMin = 5;
    constexpr std::uint64_t kTenthsMax = 100;
    return value >= kTenthsMin && value <= kTenthsMax ? std::optional(static_cast<double>(value) / 10.0)
                                                      : std::nullopt;
  }
  const bool known = value >= first_rate_value && value - first_rate_value < rates_hz.size();
  return known ? std::optional(rates_hz[value - first_rate_value]) : std::nullopt;
}

LwnxProduct lwnx_product(LwnxModel model) {
  LwnxProduct product = make(model);
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

}  // namespace slamsensor::tools
