#include "hal/rangefinder/benewake_frame.hpp"
#include "hal/rangefinder/range_driver.hpp"

#include <gtest/gtest.h>

namespace slamsensor::hal {
namespace {

TEST(BenewakeProduct, CodesOfEveryProductAreNoDistance) {
  struct Row {
    BenewakeModel model;
    BenewakeReading reading;
    Echo echo;
  };
  const std::uint16_t minus_one = 0xFFFF;
  const std::uint16_t minus_two = 0xFFFE;
  const std::uint16_t minus_four = 0xFFFC;
  const Row rows[] = {
      {BenewakeModel::Tf03, {1234, 1200, 0}, Echo::Return},
      {BenewakeModel::Tf03, {1234, 40, 0}, Echo::Return},
      {BenewakeModel::Tf03, {1234, 39, 0}, Echo::Weak},
      {BenewakeModel::Tf03, {18000, 12, 0}, Echo::None},
      {BenewakeModel::Tf03, {18000, 1200, 0}, Echo::None},
      {BenewakeModel::Tf03, {18001, 1200, 0}, Echo::None},
      {BenewakeModel::Tf03, {0, 1200, 0}, Echo::None},
      {BenewakeModel::Tf03, {1234, 3000, 0}, Echo::Saturated},
      {BenewakeModel::Tf03, {0, 0xFFFF, 0}, Echo::Saturated},
      {BenewakeModel::Tf03, {1234, 0xFFFF, 0}, Echo::Saturated},
      {BenewakeModel::Tf03, {18000, 0xFFFF, 0}, Echo::Saturated},
      {BenewakeModel::TfMini, {0, 0xFFFF, 0}, Echo::Saturated},
      {BenewakeModel::TfMini, {minus_one, 0xFFFF, 0}, Echo::Saturated},
      {BenewakeModel::TfMiniPlus, {0, 0xFFFF, 0}, Echo::Saturated},
      {BenewakeModel::TfMiniPlus, {500, 0xFFFE, 0}, Echo::Saturated},
      {BenewakeModel::TfMiniS, {minus_four, 0xFFFF, 0}, Echo::Fault},
      {BenewakeModel::Tf02, {0, 0xFFFF, 0}, Echo::Saturated},
      {BenewakeModel::Tf02, {500, 0xFFFF, 8}, Echo::Saturated},
      {BenewakeModel::TfMini, {minus_one, 10, 0}, Echo::None},
      {BenewakeModel::TfMini, {500, 19, 0}, Echo::Weak},
      {BenewakeModel::TfMini, {500, 20, 0}, Echo::Return},
      {BenewakeModel::TfMiniPlus, {0, 50, 0}, Echo::None},
      {BenewakeModel::TfMiniPlus, {minus_one, 50, 0}, Echo::None},
      {BenewakeModel::TfMiniPlus, {500, 99, 0}, Echo::Weak},
      {BenewakeModel::TfMiniS, {minus_one, 50, 0}, Echo::None},
      {BenewakeModel::TfMiniS, {minus_two, 50, 0}, Echo::Saturated},
      {BenewakeModel::TfMiniS, {minus_four, 50, 0}, Echo::Fault},
      {BenewakeModel::TfMiniS, {0x8000, 500, 0}, Echo::Fault},
      {BenewakeModel::Tf02, {500, 500, 7}, Echo::Return},
      {BenewakeModel::Tf02, {500, 500, 8}, Echo::Return},
      {BenewakeModel::Tf02, {500, 500, 6}, Echo::Weak},
      {BenewakeModel::Tf02, {minus_one, 500, 8}, Echo::None},
  };
  for (const Row& row : rows) {
    const BenewakeProduct& product = benewake_product(row.model);
    const RangeConfig range = {
        .range_max_m = 400.0, .weak_below = product.weak_below, .saturated_from = 3000.0};
    const std::uint16_t over_range = row.model == BenewakeModel::Tf03 ? 18000 : 0;
    const Measurement out = judged(measured(row.reading, product, over_range), Strength::Known, range);
    EXPECT_EQ(out.echo, row.echo) << product.name << " " << row.reading.distance_cm << " "
                                  << row.reading.strength;
    EXPECT_EQ(out.range_m > 0.0, row.echo == Echo::Return);
  }
}

}  // namespace
}  // namespace slamsensor::hal
