#pragma once

#include "hal/counters.hpp"
#include "hal/fixed_text.hpp"
#include "hal/init_error.hpp"
#include "hal/stamp.hpp"
#include "hal/transport/reopen.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstdint>
#include <netinet/in.h>
#include <span>
#include <string>
#include <string_view>

struct _lcm_t;

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

/// Gets every LCM message that the sensor publishes, in order, whether the network took it or not: a
/// recording hears the same without a network.
class MessageTap {
 public:
  MessageTap() = default;
  MessageTap(const MessageTap&) = delete;
  MessageTap& operator=(const MessageTap&) = delete;
  virtual ~MessageTap() = default;

  /// `channel` has 1 to 63 characters; both views end with the call. On the thread that publishes.
  virtual void published(std::string_view channel, std::span<const std::uint8_t> bytes) noexcept = 0;
};

/// Longest name of an LCM channel (LCM_MAX_CHANNEL_NAME_LENGTH).
inline constexpr std::size_t kLcmChannelMax = 63;

/// Name of a channel as liblcm takes it, ended by a zero.
class LcmChannel {
 public:
  LcmChannel() = default;
  /// `prefix` and `name` together; what exceeds kLcmChannelMax characters is cut off.
  explicit LcmChannel(std::string_view prefix, std::string_view name = {}) noexcept;

  [[nodiscard]] const char* c_str() const noexcept { return text_.data(); }
  [[nodiscard]] std::string_view view() const noexcept { return text_.data(); }
  [[nodiscard]] bool empty() const noexcept { return text_.front() == '\0'; }

 private:
  std::array<char, kLcmChannelMax + 1> text_{};
};

enum class LcmEvent : std::uint8_t { Published, NotOpen, SendFailed, Opened, OpenFailed };
using LcmCounters = hal::EventCounters<LcmEvent, 5>;

/// Sends LCM messages, and only that: it never subscribes, so liblcm makes no thread and receives nothing.
/// Without a route for multicast it is closed, says so, and is opened by `service` as soon as there is one.
/// All calls on one thread, which may block for as long as a socket's send may.
class LcmSink {
 public:
  explicit LcmSink(LcmUrl url);
  LcmSink(const LcmSink&) = delete;
  LcmSink& operator=(const LcmSink&) = delete;
  ~LcmSink();

  /// `tap` hears every message from now on; null: nobody does.
  void set_tap(MessageTap* tap) noexcept { tap_ = tap; }

  /// Opens the sink when it is closed and an attempt is due: at once the first time, then after 1 s, doubling
  /// to 30 s. Call it at least once a second.
  void service(hal::Stamp now) noexcept;

  /// Hands one message of at most 65,499 bytes less the channel to the network; false, and counted, when it
  /// could not. Beside the process' first message, for which glib takes four small blocks, an open sink
  /// allocates nothing here.
  bool publish(const LcmChannel& channel, std::span<const std::uint8_t> bytes) noexcept;

  [[nodiscard]] bool is_open() const noexcept { return lcm_ != nullptr; }

  /// Why messages do not go out, and what to do about it; empty while they do.
  [[nodiscard]] std::string_view problem() const noexcept { return problem_.view(); }

  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept { return counters_.all(); }

 private:
  /// `error` is an errno value, 0 when there is none.
  void set_problem(std::string_view what, int error, std::string_view advice) noexcept;
  [[nodiscard]] bool open() noexcept;

  LcmUrl url_;
  _lcm_t* lcm_ = nullptr;
  MessageTap* tap_ = nullptr;
  hal::ReopenTimer reopen_;
  hal::FixedText<160> problem_;
  bool is_failing_ = false;  ///< the last message was not taken
  LcmCounters counters_;
};

}  // namespace slamsensor::firmware
