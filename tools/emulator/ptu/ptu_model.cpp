#include "tools/emulator/ptu/ptu_model.hpp"

#include <array>

namespace slamsensor::tools {
namespace {

// resolution, min, max, speed, acceleration, base, lower, upper, upper at most
constexpr std::array<PtuModel, 4> kModels = {{
    {"PTU-46-17.5",
     PtuSeries::Dp,
     {185.1428, -3090, 3090, 1000, 2000, 1000, 31, 2902, 5833},
     {185.1428, -907, 604, 1000, 2000, 1000, 31, 2902, 5833}},
    {"PTU-46-70",
     PtuSeries::Dp,
     {46.2857, -12360, 12360, 1000, 2000, 1000, 31, 2902, 4666},
     {46.2857, -3628, 2416, 1000, 2000, 1000, 31, 2902, 4666}},
    {"PTU-E46-17.5",
     PtuSeries::E,
     {92.5714, -6180, 6180, 2000, 4000, 57, 57, 5804, 11666},
     {46.2857, -3628, 2416, 2000, 4000, 57, 57, 5804, 11666}},
    {"PTU-D300E",
     PtuSeries::E,
     {23.142857, -26133, 26133, 1000, 2000, 57, 57, 1985, 7777},
     {23.142857, -14000, 4666, 1000, 2000, 57, 57, 1985, 7777}},
}};

}  // namespace

const PtuModel& ptu_model(PtuKind kind) {
  return kModels[static_cast<std::size_t>(kind)];
}

}  // namespace slamsensor::tools
