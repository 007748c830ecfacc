#pragma once

#include "firmware/device/head_drivers.hpp"
#include "firmware/recording/tape_format.hpp"
#include "firmware/recording/tape_writer.hpp"
#include "firmware/scan/sensor_head.hpp"

#include <optional>

namespace slamsensor::firmware {

/// Gives `head` what `what` stands for. A command that is recorded is given through this and no other way, so
/// that it is the same when it is played. An argument that stands for nothing is passed over.
void command(SensorHead& head, TapeCommand what, std::uint64_t argument) noexcept;

/// One link's place on a tape, if there is a tape.
class LinkTape {
 public:
  explicit LinkTape(HeadLink link) noexcept : link_(link) {}

  /// Begins on `tape`, null for none, with the link in `state`.
  void attach(TapeWriter* tape, const TapeLinkState& state) noexcept;

  /// The tape that is being written, or null.
  [[nodiscard]] TapeWriter* get() const noexcept { return tape_; }
  [[nodiscard]] HeadLink link() const noexcept { return link_; }

  /// The link stands so after service(), or after another call; written when that is new.
  void note_service(const TapeLinkState& state) noexcept;
  void note_call(const TapeLinkState& state) noexcept;

 private:
  HeadLink link_;
  TapeWriter* tape_ = nullptr;
  TapeLinkState told_;
};

/// Stands before a byte link and writes everything that passes onto a tape; without a tape it only passes it
/// on. Allocates nothing, waits for nothing.
class RecordingByteLink final : public hal::ByteLink {
 public:
  /// `inner` outlives it.
  RecordingByteLink(hal::ByteLink& inner, HeadLink link) noexcept : inner_(inner), tape_(link) {}

  /// Writes onto `tape`, or no longer when it is null. A tape that is to be played begins before the driver
  /// on this link is made.
  void attach(TapeWriter* tape) noexcept { tape_.attach(tape, look()); }

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return inner_.epoch(); }
  [[nodiscard]] bool is_up() const noexcept override { return inner_.is_up(); }
  [[nodiscard]] std::string_view problem() const noexcept override { return inner_.problem(); }
  [[nodiscard]] hal::ByteRead read(std::span<std::uint8_t> into) noexcept override;
  [[nodiscard]] hal::LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override;
  hal::LinkStatus set_baud(std::uint32_t baud) noexcept override;
  [[nodiscard]] std::uint32_t baud() const noexcept override { return inner_.baud(); }
  void discard_input() noexcept override;

 private:
  [[nodiscard]] TapeLinkState look() const noexcept;

  hal::ByteLink& inner_;
  LinkTape tape_;
};

/// The same before a CAN link.
class RecordingCanLink final : public hal::CanLink {
 public:
  RecordingCanLink(hal::CanLink& inner, HeadLink link) noexcept : inner_(inner), tape_(link) {}

  void attach(TapeWriter* tape) noexcept { tape_.attach(tape, look()); }

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return inner_.epoch(); }
  [[nodiscard]] bool is_up() const noexcept override { return inner_.is_up(); }
  [[nodiscard]] std::string_view problem() const noexcept override { return inner_.problem(); }
  [[nodiscard]] hal::CanRead receive() noexcept override;
  [[nodiscard]] hal::LinkStatus send(const hal::CanFrame& frame) noexcept override;

 private:
  [[nodiscard]] TapeLinkState look() const noexcept;

  hal::CanLink& inner_;
  LinkTape tape_;
};

/// The links of a head, each with a tap before it.
class RecordingHeadLinks {
 public:
  /// What `inner` points to outlives it.
  explicit RecordingHeadLinks(const HeadLinks& inner) noexcept;

  /// What drivers are made on.
  [[nodiscard]] HeadLinks get() noexcept;

  /// As RecordingByteLink::attach(), for all of them.
  void attach(TapeWriter* tape) noexcept;

 private:
  std::optional<RecordingByteLink> pan_tilt_bytes_;
  std::optional<RecordingCanLink> pan_tilt_can_;
  std::optional<RecordingByteLink> rangefinder_bytes_;
  std::optional<RecordingCanLink> rangefinder_can_;
};

}  // namespace slamsensor::firmware
