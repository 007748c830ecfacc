#include "firmware/lcm/message.hpp"

#include <gtest/gtest.h>

namespace slamsensor::firmware {
namespace {

// What lcm-gen 1.3.1 makes of two types.
TEST(LcmFingerprint, IsThatOfLcmGen) {
  EXPECT_EQ(lcm_fingerprint({{"utime", "int64_t", ""}, {"degCelsius", "double", ""}}), 0xA07FA3D64CBEA6EAU);
  EXPECT_EQ(lcm_fingerprint({{"utime", "int64_t", ""},
                             {"pos", "double", "3"},
                             {"vel", "double", "3"},
                             {"orientation", "double", "4"},
                             {"rotation_rate", "double", "3"},
                             {"accel", "double", "3"}}),
            0x2E16EFB052B0105EU);
}

}  // namespace
}  // namespace slamsensor::firmware
