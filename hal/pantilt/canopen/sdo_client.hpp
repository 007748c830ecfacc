#pragma once

#include "hal/fixed_text.hpp"
#include "hal/pantilt/canopen/canopen_config.hpp"
#include "hal/pantilt/canopen/canopen_counters.hpp"
#include "hal/pantilt/canopen/sdo_frame.hpp"
#include "hal/stamp.hpp"
#include "hal/transport/can_link.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace slamsensor::hal {

struct SdoRequest {
  enum class Kind : std::uint8_t { Read, ReadText, Write };

  Kind kind = Kind::Read;
  SdoAddress address;
  std::uint32_t value = 0;  ///< of a Write
  std::uint8_t size = 4;    ///< of a Write, bytes

  [[nodiscard]] static constexpr SdoRequest read(SdoAddress address) noexcept {
    return {Kind::Read, address, 0, 4};
  }
  [[nodiscard]] static constexpr SdoRequest write(SdoAddress address, std::uint32_t value,
                                                  std::uint8_t size) noexcept {
    return {Kind::Write, address, value, size};
  }
};

enum class SdoOutcome : std::uint8_t { Done, Aborted, TimedOut };

struct SdoResult {
  SdoRequest request;
  SdoOutcome outcome = SdoOutcome::TimedOut;
  std::uint32_t value = 0;  ///< read; the code when aborted
  std::uint8_t size = 0;    ///< bytes of what was read
  Stamp sent{};             ///< the request, at its last attempt
  Stamp received{};

  /// What was read as a signed number of its size.
  [[nodiscard]] std::int32_t signed_value() const noexcept;
};

using DeviceName = FixedText<80>;

/// The client's end of a node's SDO channel (CiA 301): one request at a time, repeated when no answer comes.
///
/// Replies are told apart by index and sub-index only. So after a time-out another object is read first: a
/// server answers in order, hence with that answer everything older has arrived.
class SdoClient {
 public:
  /// All of them outlive this.
  SdoClient(std::uint8_t node, const CanopenConfig& config, CanLink& link, CanopenCounters& counters) noexcept
      : node_(node), config_(config), link_(link), counters_(counters) {}

  /// No request, none outstanding: the node has started anew.
  void reset() noexcept;

  /// Neither a request under way nor a result to take.
  [[nodiscard]] bool is_idle() const noexcept { return phase_ == Phase::Idle; }

  /// Begins `request`; nothing happens unless is_idle().
  void begin(const SdoRequest& request, Stamp now) noexcept;

  /// Sends what waits for room on the bus and repeats what was not answered.
  void step(Stamp now) noexcept;

  /// A frame of this node's reply channel.
  void on_frame(const CanRead& got, Stamp now) noexcept;

  /// The result, once; then the client is idle.
  [[nodiscard]] std::optional<SdoResult> take() noexcept;

  /// What the last ReadText read, at most 80 characters.
  [[nodiscard]] DeviceName text() const noexcept;

 private:
  enum class Phase : std::uint8_t { Idle, Marker, Request, Segments, Finished };

  void send(const CanFrame& frame, Stamp now) noexcept;
  void send_request(Stamp now) noexcept;
  void send_marker(Stamp now) noexcept;
  void on_segment(const SdoReply& reply, const CanRead& got, Stamp now) noexcept;
  void on_reply(const SdoReply& reply, const CanRead& got, Stamp now) noexcept;
  void keep_expedited(const SdoReply& reply) noexcept;
  void finish(SdoOutcome outcome, std::uint32_t value, Stamp received) noexcept;
  [[nodiscard]] SdoAddress marker() const noexcept;

  const std::uint8_t node_;
  const CanopenConfig& config_;
  CanLink& link_;
  CanopenCounters& counters_;
  Phase phase_ = Phase::Idle;
  SdoResult result_;
  CanFrame outgoing_;
  bool unsent_ = false;
  bool suspect_ = false;  // a reply to something given up may still come
  std::uint8_t attempts_ = 0;
  std::uint8_t toggle_ = 0;
  Stamp deadline_{};
  std::array<char, 80> text_{};
  std::size_t text_size_ = 0;
  std::size_t segments_ = 0;
};

}  // namespace slamsensor::hal
