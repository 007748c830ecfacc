#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/device/head_drivers.hpp"
#include "firmware/recording/tape_format.hpp"
#include "firmware/scan/sensor_head.hpp"
#include "tools/input/text.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace slamsensor::tools {

/// One operation of a tape; which of its values count depends on `op` (firmware/recording/tape_format.hpp).
struct TapeOperation {
  firmware::TapeOp op = firmware::TapeOp::End;
  firmware::HeadLink link{};
  hal::LinkStatus status = hal::LinkStatus::Busy;
  hal::Stamp time{};  ///< of a step, or the stamp of what was read or received
  firmware::TapeLinkState state;
  hal::CanFrame frame;
  std::span<const std::uint8_t> bytes;  ///< in the chunk
  std::uint32_t baud = 0;
  firmware::TapeCommand command{};
  std::uint64_t number = 0;  ///< argument of a command, or operations lost
};

/// Takes the chunks of a tape apart, in their order. Every number is held against its bounds.
class TapeReader {
 public:
  /// Goes on with `chunk`, which stays until the next one.
  void load(std::span<const std::uint8_t> chunk) noexcept;

  /// The next operation; nothing at the end of the chunk, and from the first byte on that is no operation.
  [[nodiscard]] std::optional<TapeOperation> next() noexcept;

  /// Whether the chunk has a byte that is no operation.
  [[nodiscard]] bool is_broken() const noexcept { return is_broken_; }

 private:
  using Operation = std::optional<TapeOperation>;
  [[nodiscard]] Operation step(TapeOperation operation) noexcept;
  [[nodiscard]] Operation fields(TapeOperation operation) noexcept;
  [[nodiscard]] bool take_state(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_stamp(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_status(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_bytes(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_frame(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_command(TapeOperation& operation) noexcept;
  [[nodiscard]] std::optional<std::uint64_t> number(std::uint64_t max) noexcept;
  [[nodiscard]] std::optional<std::int64_t> signed_number() noexcept;

  std::span<const std::uint8_t> rest_;
  hal::Stamp now_{};
  hal::Stamp period_{};
  bool is_first_step_ = true;
  bool is_broken_ = false;
};

/// Where the chunks of a tape come from, in their order.
class ChunkSource {
 public:
  struct Chunk {
    std::int64_t number = 0;
    std::span<const std::uint8_t> bytes;  ///< until the next chunk is asked for
  };

  ChunkSource() = default;
  ChunkSource(const ChunkSource&) = delete;
  ChunkSource& operator=(const ChunkSource&) = delete;
  virtual ~ChunkSource() = default;

  /// The next chunk, or nothing after the last.
  [[nodiscard]] virtual std::optional<Chunk> next() = 0;
};

/// Why a tape plays no further.
enum class TapeEnd : std::uint8_t {
  None,          ///< it plays
  Complete,      ///< it was recorded to here
  Cut,           ///< it stops without having been ended: the program that wrote it was, or the file was cut
  ChunkMissing,  ///< the next chunk is not in the file, or damaged
  Broken,        ///< a chunk holds what is no operation
  Lost,          ///< the recorder could not keep up
  Diverged,      ///< who is played to does something else than is on the tape
};

/// Plays one tape, strictly in its order, to whoever stands where the recorded drivers stood. At the first
/// thing that does not fit the tape it is over: it says why and where, and gives no more answers.
class TapePlayer {
 public:
  /// `chunks` outlives this.
  explicit TapePlayer(ChunkSource& chunks);

  /// How each link stood when the recording began; none for one that the head does not have.
  [[nodiscard]] const std::optional<firmware::TapeLinkState>& opened(firmware::HeadLink link) const noexcept {
    return opened_[static_cast<std::size_t>(link)];
  }

  /// What comes next between two steps: a step or a command. Nothing when the tape is over.
  [[nodiscard]] std::optional<TapeOperation> next();

  /// Whether the step that was last given out was played to its last operation.
  [[nodiscard]] bool has_ended_step();

  /// The operation that a call of `link` is answered from: the next one, if it is one of `ops`. Its bytes are
  /// there until the next call.
  [[nodiscard]] std::optional<TapeOperation> answer(firmware::HeadLink link,
                                                    std::initializer_list<firmware::TapeOp> ops);

  /// The state that `link` has taken on by `op` (Service or After), if that comes next.
  [[nodiscard]] std::optional<firmware::TapeLinkState> state_change(firmware::HeadLink link,
                                                                    firmware::TapeOp op);

  /// The driver does `done` where the last answer says otherwise. Said right after that answer.
  void diverge(const std::string& done);

  [[nodiscard]] TapeEnd end() const noexcept { return end_; }
  /// Why and where it is over, for a person; empty while it plays.
  [[nodiscard]] const std::string& end_text() const noexcept { return end_text_; }
  /// The time of the last step.
  [[nodiscard]] hal::Stamp now() const noexcept { return now_; }
  [[nodiscard]] std::int64_t chunks_begun() const noexcept { return chunk_ + 1; }

 private:
  [[nodiscard]] bool look_ahead();
  void load_chunk();
  void pop();
  void finish(TapeEnd end, const std::string& text);
  [[nodiscard]] std::string place() const;

  ChunkSource& chunks_;
  TapeReader reader_;
  std::optional<TapeOperation> next_;
  std::optional<TapeOperation> last_;
  std::array<std::optional<firmware::TapeLinkState>, firmware::kHeadLinkNames.size()> opened_;
  std::int64_t chunk_ = -1;
  std::uint64_t operation_ = 0;  // number of next_ in its chunk, from 1
  hal::Stamp now_{};
  TapeEnd end_ = TapeEnd::None;
  std::string end_text_;
};

/// An operation as a message names it: "a write of 'PP2500 ' to the pan-tilt port".
[[nodiscard]] std::string text_of(const TapeOperation& operation);

/// A byte link as a driver met it when a tape was recorded. When the tape is over nothing arrives any more.
class PlaybackByteLink final : public hal::ByteLink {
 public:
  /// `player` outlives it and has opened `link`.
  PlaybackByteLink(TapePlayer& player, firmware::HeadLink link);

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return state_.epoch; }
  [[nodiscard]] bool is_up() const noexcept override { return state_.is_up; }
  [[nodiscard]] hal::ByteRead read(std::span<std::uint8_t> into) noexcept override;
  [[nodiscard]] hal::LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override;
  hal::LinkStatus set_baud(std::uint32_t baud) noexcept override;
  [[nodiscard]] std::uint32_t baud() const noexcept override { return state_.baud; }
  void discard_input() noexcept override;

 private:
  void follow(firmware::TapeOp op);

  TapePlayer& player_;
  firmware::HeadLink link_;
  firmware::TapeLinkState state_;
};

/// The same for a CAN link.
class PlaybackCanLink final : public hal::CanLink {
 public:
  PlaybackCanLink(TapePlayer& player, firmware::HeadLink link);

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return state_.epoch; }
  [[nodiscard]] bool is_up() const noexcept override { return state_.is_up; }
  [[nodiscard]] hal::CanRead receive() noexcept override;
  [[nodiscard]] hal::LinkStatus send(const hal::CanFrame& frame) noexcept override;

 private:
  void follow(firmware::TapeOp op);

  TapePlayer& player_;
  firmware::HeadLink link_;
  firmware::TapeLinkState state_;
};

/// The links of the head whose tape it is.
[[nodiscard]] firmware::OwnedHeadLinks playback_links(TapePlayer& player);

/// A recorded sensor head: its drivers and its scan scheduler at work again, on a tape instead of devices.
/// Gives the same readings, scanlines and scans as when it was recorded, bit for bit.
class HeadPlayback {
 public:
  /// The head that `config` describes on the tape from `chunks`, which outlives this. Refused when `config`
  /// asks for other devices than the tape has.
  [[nodiscard]] static tl::expected<std::unique_ptr<HeadPlayback>, InputError> create(
      ChunkSource& chunks, const firmware::Config& config);

  /// The next thing that the head did; nothing when the tape is over. What an interrupted last step did is
  /// left out. Spans are valid until the next call.
  [[nodiscard]] std::optional<firmware::HeadEvent> next();

  [[nodiscard]] const TapePlayer& player() const noexcept { return player_; }
  [[nodiscard]] const firmware::SensorHead& sensor() const noexcept { return *sensor_; }
  [[nodiscard]] const firmware::HeadDrivers& drivers() const noexcept { return drivers_; }

 private:
  explicit HeadPlayback(ChunkSource& chunks) : player_(chunks), links_(playback_links(player_)) {}
  [[nodiscard]] tl::expected<void, InputError> start(const firmware::Config& config);

  TapePlayer player_;
  firmware::OwnedHeadLinks links_;
  firmware::HeadDrivers drivers_;
  std::unique_ptr<firmware::SensorHead> sensor_;
};

}  // namespace slamsensor::tools
