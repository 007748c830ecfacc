#include "tests/fuzz/wires/fuzz_device.hpp"
#include "tools/emulator/rangefinder/emulated_tf03.hpp"

// The first byte picks the model. Whatever a host says, the device says no more than its line carries.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::tools;  // NOLINT(google-build-using-namespace)
  if (size == 0) {
    return 0;
  }
  Tf03Settings settings = tf03_settings(static_cast<BenewakeModel>(data[0] % 5));
  settings.begin = DeviceBegin::Ready;
  slamsensor::tests::talk_to<EmulatedTf03>(settings, {data + 1, size - 1});
  return 0;
}
