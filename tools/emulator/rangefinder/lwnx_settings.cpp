#include "tools/emulator/rangefinder/lwnx_settings.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {

void set_rate(LwnxSettings& settings, double rate_hz) {
  LwnxProduct& product = settings.product;
  LwnxRegister* const rate = product.find(product.ids.update_rate);
  LwnxRegister* const high_speed = product.find(product.ids.high_speed);
  if (high_speed != nullptr) {
    high_speed->initial = 2.0 * rate_hz >= settings.full_speed_hz ? 1 : 0;
  }
  if (rate == nullptr) {
    return;
  }
  if (product.rates_hz.empty()) {
    rate->initial = std::clamp<std::int64_t>(std::llround(rate_hz * 10.0), 5, 100);
    return;
  }
  const auto nearest = std::ranges::min_element(
      product.rates_hz, {}, [rate_hz](double each) { return std::abs(std::log(each / rate_hz)); });
  rate->initial = product.first_rate_value + (nearest - product.rates_hz.begin());
}

}  // namespace slamsensor::tools
