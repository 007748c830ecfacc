#include "firmware/lcm/lcm_sink.hpp"

#include <gtest/gtest.h>

#include <arpa/inet.h>

namespace slamsensor::firmware {
namespace {

TEST(LcmUrl, ComesFromTheSettingsElseTheEnvironmentElseLcm) {
  EXPECT_EQ(resolve_lcm_url("udpm://239.0.0.1:1", "udpm://239.0.0.2:2")->text, "udpm://239.0.0.1:1");
  EXPECT_EQ(resolve_lcm_url("", "udpm://239.0.0.2:2")->text, "udpm://239.0.0.2:2");
  EXPECT_EQ(resolve_lcm_url("", "")->text, "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_EQ(resolve_lcm_url("", nullptr)->text, "udpm://239.255.76.67:7667?ttl=0");
}

TEST(LcmUrl, LeavesOutWhatLcmLeavesOut) {
  const auto only_ttl = resolve_lcm_url("udpm://?ttl=1", nullptr);
  ASSERT_TRUE(only_ttl);
  EXPECT_EQ(only_ttl->group.sin_addr.s_addr, inet_addr("239.255.76.67"));
  EXPECT_EQ(ntohs(only_ttl->group.sin_port), 7667);
  EXPECT_EQ(only_ttl->ttl, 1);
  const auto only_port = resolve_lcm_url("udpm://:7700", nullptr);
  ASSERT_TRUE(only_port);
  EXPECT_EQ(ntohs(only_port->group.sin_port), 7700);
  const auto all = resolve_lcm_url("udpm://225.1.2.3:9?recv_buf_size=100000&ttl=255", nullptr);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->ttl, 255);
  EXPECT_EQ(resolve_lcm_url("memq://", nullptr)->transport, LcmTransport::Memory);
}

TEST(LcmUrl, RefusesWhatCannotBeSentTo) {
  for (const char* url :
       {"tcpq://127.0.0.1:7700", "file:///a", "udpm:/239.1.1.1:1", "udpm://192.168.0.1:7667",
        "udpm://239.255.76.67:0", "udpm://239.255.76.67:65536", "udpm://239.255.76.67:7667x", "udpm://name:1",
        "udpm://?ttl=256", "udpm://?ttl=-1", "udpm://?ttl", "udpm://?hops=1", "nonsense", "memq://x"}) {
    EXPECT_FALSE(resolve_lcm_url(url, nullptr)) << url;
  }
}

TEST(LcmUrl, SaysWhereItCameFromAndWhatIsAllowed) {
  EXPECT_EQ(resolve_lcm_url("tcpq://host", nullptr).error().message,
            "lcm.url is \"tcpq://host\": only udpm://GROUP:PORT?ttl=N is sent to, for example "
            "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_EQ(
      resolve_lcm_url("", "udpm://10.0.0.1:7667").error().message,
      "LCM_DEFAULT_URL is \"udpm://10.0.0.1:7667\": the group must be an IPv4 address from 224.0.0.0 to "
      "239.255.255.255, for example udpm://239.255.76.67:7667?ttl=0");
}

}  // namespace
}  // namespace slamsensor::firmware
