#include "hal/transport/can_socket.hpp"

#include <gmock/gmock.h>

namespace slamsensor::hal {
namespace {

using testing::HasSubstr;

std::string refusal(const CanConfig& config) {
  const auto socket = CanSocket::create(config);
  return socket ? "" : socket.error().message;
}

TEST(CanSocket, RefusesNamesThatNoInterfaceHas) {
  for (const char* const name : {"", "sixteen_letters_", "a/b", "can 0", "..", "can0:1"}) {
    EXPECT_THAT(refusal({name, {}, {}}), HasSubstr("must be that of a network interface")) << name;
  }
  EXPECT_EQ(refusal({"fifteen_letters", {}, {}}), "");
}

TEST(CanSocket, BoundsItsFilters) {
  CanConfig config{"can0", std::vector<CanFilter>(16), {}};
  EXPECT_EQ(refusal(config), "");
  config.filters.push_back({});
  EXPECT_THAT(refusal(config), HasSubstr("17 filters; at most 16"));
  EXPECT_THAT(refusal({"can0", {{0x800, 0x7FF, false}}, {}}), HasSubstr("more than 11 bits"));
  EXPECT_THAT(refusal({"can0", {{0, 0x2000'0000, true}}, {}}), HasSubstr("more than 29 bits"));
}

TEST(CanSocket, RefusesImpossibleWaits) {
  EXPECT_THAT(refusal({"can0", {}, {Stamp{}, Stamp{}}}), HasSubstr("waits before reopening"));
}

TEST(CanSocket, AnInterfaceThatIsNotThereIsTriedAgain) {
  const auto socket = CanSocket::create({"nosuchcan0", {}, {}});
  ASSERT_TRUE(socket);
  (*socket)->service(std::chrono::seconds(1));
  EXPECT_FALSE((*socket)->is_up());
  EXPECT_EQ((*socket)->fd(), -1);
  EXPECT_THAT(std::string((*socket)->problem()), HasSubstr("CAN interface nosuchcan0: "));
  (*socket)->service(std::chrono::milliseconds(1049));
  EXPECT_EQ((*socket)->counters()[static_cast<std::size_t>(CanEvent::OpenFailed)].value, 1U);
  (*socket)->service(std::chrono::milliseconds(1050));
  EXPECT_EQ((*socket)->counters()[static_cast<std::size_t>(CanEvent::OpenFailed)].value, 2U);
}

}  // namespace
}  // namespace slamsensor::hal
