#pragma once

#include "hal/init_error.hpp"

#include <tl/expected.hpp>

#include <netinet/in.h>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// Where LCM messages go.
enum class LcmTransport : std::uint8_t {
  Multicast,  ///< udpm://, to the network or, with ttl 0, to this machine alone
  Memory,     ///< memq://, to nobody: for tests
};

/// A checked LCM URL.
struct LcmUrl {
  std::string text;  ///< as liblcm takes it
  LcmTransport transport = LcmTransport::Multicast;
  sockaddr_in group{};  ///< address and port of Multicast
  int ttl = 0;
};

/// The URL that is in force: `configured`, else `environment` (LCM_DEFAULT_URL; may be null), else LCM's own
/// default, udpm://239.255.76.67:7667?ttl=0. Allowed are udpm://[GROUP][:PORT][?ttl=N&recv_buf_size=N] with
/// an IPv4 multicast group, port 1 to 65535 and ttl 0 to 255, and memq://. liblcm's tcpq:// is refused: 1.3.1
/// leaks a file descriptor per failed connection and aborts. The error names where the URL came from.
[[nodiscard]] tl::expected<LcmUrl, hal::InitError> resolve_lcm_url(std::string_view configured,
                                                                   const char* environment);

}  // namespace slamsensor::firmware
