#include "tests/fuzz/wires/fuzz_device.hpp"
#include "tools/emulator/rangefinder/emulated_lwnx.hpp"

// The first byte picks the product. Whatever a host says, the device says no more than its line carries.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::tools;  // NOLINT(google-build-using-namespace)
  if (size == 0) {
    return 0;
  }
  constexpr unsigned kModels = static_cast<unsigned>(LwnxModel::Grf500) + 1;
  LwnxSettings settings;
  settings.product = lwnx_product(static_cast<LwnxModel>(data[0] % kModels));
  settings.begin = DeviceBegin::Ready;
  slamsensor::tests::talk_to<EmulatedLwnx>(settings, {data + 1, size - 1});
  return 0;
}
