#pragma once

#include "hal/counters.hpp"
#include "hal/fixed_text.hpp"
#include "hal/pantilt/canopen/canopen_config.hpp"
#include "hal/pantilt/canopen/cia402.hpp"
#include "hal/stamp.hpp"
#include "hal/transport/can_link.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::hal {

/// The frame that writes the low `size` bytes (1 to 4) of `value` (expedited download, CiA 301).
[[nodiscard]] CanFrame sdo_write(std::uint8_t node, SdoAddress address, std::uint32_t value,
                                 std::uint8_t size) noexcept;

/// The frame that asks for a value (upload).
[[nodiscard]] CanFrame sdo_read(std::uint8_t node, SdoAddress address) noexcept;

/// The frame that asks for the next segment; `toggle` is 0 for the first, then 1, 0, ...
[[nodiscard]] CanFrame sdo_read_segment(std::uint8_t node, std::uint8_t toggle) noexcept;

/// The frame by which the client gives a transfer up.
[[nodiscard]] CanFrame sdo_abort(std::uint8_t node, SdoAddress address, std::uint32_t code) noexcept;

/// The frame of a network management command to `node`; 0 is all nodes.
[[nodiscard]] CanFrame nmt_frame(NmtCommand command, std::uint8_t node) noexcept;

enum class SdoReplyKind : std::uint8_t {
  Written,
  Value,      ///< expedited upload: `value`, `size`
  LongValue,  ///< a segmented upload begins; `value` is its length in bytes where given, else 0
  Segment,    ///< `bytes`, `size`, `toggle`, `last`
  Abort,      ///< `value` is the code
};

struct SdoReply {
  SdoReplyKind kind = SdoReplyKind::Abort;
  SdoAddress address;  ///< not of a Segment, which carries none
  std::uint32_t value = 0;
  std::uint8_t size = 0;  ///< bytes of `value` or of `bytes`
  std::uint8_t toggle = 0;
  bool last = false;
  std::array<std::uint8_t, 7> bytes{};
};

/// What the 8 bytes of a server's reply say; nothing when they have another length or an unknown command.
[[nodiscard]] std::optional<SdoReply> parse_sdo_reply(const CanFrame& frame) noexcept;

/// The little-endian number in `size` (at most 4) bytes of `frame` from `offset` on; 0 where it has none.
[[nodiscard]] std::uint32_t le_number(const CanFrame& frame, std::size_t offset, std::size_t size) noexcept;

/// Writes `size` (at most 4) bytes of `value` into `frame` at `offset`, as far as it has room.
void put_le(CanFrame& frame, std::size_t offset, std::size_t size, std::uint32_t value) noexcept;

/// What a CANopen pan-tilt driver counts, in the order of kCanopenEventNames.
enum class CanopenEvent : std::uint8_t {
  FramesMalformed,    ///< of this unit, with a length or a content it cannot have
  SdoRepliesForeign,  ///< to a request given up, or to none
  SdoAborts,          ///< requests the node refused
  SdoTimeouts,        ///< requests without an answer in time
  SdoRepeats,         ///< requests sent again
  SendsBusy,          ///< frames that waited because the bus had no room
  SyncsLate,          ///< SYNC sent more than a period late
  HeartbeatsLost,     ///< times a heartbeat stayed away
  BootUps,            ///< a node in use started anew
  Emergencies,        ///< EMCY messages that report an error
  Faults,             ///< a drive in use fell into its fault state
  StatesLost,         ///< a node or drive in use left its operating state
  Restarts,           ///< start-ups of a node after its first
  SettingsRefused,    ///< optional objects and settings a node does not have
  MappingsFixed,      ///< PDOs whose map could not be set
  PositionsSilent,    ///< times positions stayed away
  PositionsUnpaired,  ///< more than one position for a SYNC, or one before any
  PositionsDropped,   ///< nobody took them
  MovesRefused,       ///< by the driver: not ready, busy, out of range
  MovesRejected,      ///< by the node
  MovesRepeated,      ///< sent again because the set-point was not acknowledged
  MovesLost,          ///< given up without an acknowledgement, or ended elsewhere
};

inline constexpr std::array<std::string_view, 22> kCanopenEventNames{
    "frames_malformed", "sdo_replies_foreign", "sdo_aborts",        "sdo_timeouts",     "sdo_repeats",
    "sends_busy",       "syncs_late",          "heartbeats_lost",   "boot_ups",         "emergencies",
    "faults",           "states_lost",         "restarts",          "settings_refused", "mappings_fixed",
    "positions_silent", "positions_unpaired",  "positions_dropped", "moves_refused",    "moves_rejected",
    "moves_repeated",   "moves_lost"};

using CanopenCounters = EventCounters<CanopenEvent, kCanopenEventNames.size()>;

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
/// Replies are distinguished by index and sub-index only. So after a time-out another object is read first: a
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
