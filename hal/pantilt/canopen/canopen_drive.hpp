#pragma once

#include "hal/pantilt/canopen/canopen_startup.hpp"
#include "hal/pantilt/canopen/cia402.hpp"
#include "hal/pantilt/pan_tilt.hpp"
#include "hal/ring.hpp"

#include <cstdint>
#include <optional>

namespace slamsensor::hal {

using CanopenSamples = Ring<AxisSample, kAxisSamplesMax>;

/// What a drive reported at one moment.
struct DriveSighting {
  Stamp stamp{};
  Stamp half_width{};
  std::uint16_t statusword = 0;
  std::int32_t position = 0;  ///< counts
};

/// One axis of a unit that is Ready: commands its moves, by PDO where there is one and else by SDO, and
/// follows its reports.
class CanopenDrive {
 public:
  /// All of them outlive this.
  CanopenDrive(Axis axis, const CanopenConfig& config, const CanopenStartup& startup, CanLink& link,
               SdoClient& sdo, CanopenCounters& counters, CanopenSamples& samples) noexcept;

  /// The axis rests where the start-up found it.
  void set_up(Stamp now) noexcept;

  /// The unit is lost: no move, no position; a halt is sent in case it still listens.
  void forget() noexcept;

  /// Takes a move. Accepted, Busy or OutOfRange.
  [[nodiscard]] MoveStatus ask(double target_rad, double speed_radps) noexcept;
  void halt() noexcept;

  /// Reads, commands and polls what is due; anything but None means the node is lost.
  [[nodiscard]] CanopenProblem step(Stamp now) noexcept;

  /// A SYNC was sent: what was sent before it is acted on now.
  void on_sync(Stamp sent) noexcept;

  /// A frame of the position PDO.
  void on_pdo(const CanRead& got) noexcept;

  [[nodiscard]] const AxisStatus& status() const noexcept { return status_; }

 private:
  enum class Phase : std::uint8_t { Rest, Prepare, SetPoint, Release, Moving, Sweep, Halting };
  struct Request {
    std::int32_t target = 0;
    double target_rad = 0.0;
    std::uint32_t speed_units = 0;
    double speed_radps = 0.0;
  };

  void step_motion(Stamp now) noexcept;
  void prepare() noexcept;
  void raise_set_point(Stamp now) noexcept;
  void step_set_point(Stamp now) noexcept;
  void start_halt(Stamp now) noexcept;
  void begin_status(Stamp begun) noexcept;
  void give_up() noexcept;
  void come_to_rest() noexcept;
  void command(std::uint16_t controlword, Stamp now) noexcept;
  void queue(const SdoRequest& request) noexcept;
  [[nodiscard]] bool is_sent() const noexcept;
  void send_waiting() noexcept;
  [[nodiscard]] CanopenProblem step_sdo(Stamp now) noexcept;
  [[nodiscard]] CanopenProblem on_result(const SdoResult& result) noexcept;
  [[nodiscard]] CanopenProblem judge(Stamp now) noexcept;
  void on_sighting(const DriveSighting& sighting) noexcept;
  void heed_end(const DriveSighting& sighting) noexcept;
  void heed_sweep(const DriveSighting& sighting) noexcept;
  [[nodiscard]] bool polls_by_sdo(Stamp now) const noexcept;

  const Axis axis_;
  const CanopenConfig& config_;
  const CanopenStartup& startup_;
  CanLink& link_;
  SdoClient& sdo_;
  CanopenCounters& counters_;
  CanopenSamples& samples_;

  AxisStatus status_;
  Phase phase_ = Phase::Rest;
  std::optional<Request> request_;
  Request move_;               // under way
  double standing_rad_ = 0.0;  // where it last rested
  DriveSighting seen_;
  Ring<SdoRequest, 8> requests_;
  std::optional<CanFrame> unsent_;
  std::uint32_t speed_set_ = 0;  // 0: not known
  std::uint8_t attempts_ = 0;
  std::uint8_t on_target_ = 0;  // sightings in a row
  bool swept_ = false;
  bool at_once_ = false;  // the set-point replaces a move or follows a halt
  bool status_next_ = true;
  bool halt_due_ = false;
  bool command_out_ = false;    // a queued request waits for its answer
  Stamp sent_at_{};             // the command that is being waited for
  std::optional<Stamp> acted_;  // when the node acted on it
  Stamp latest_sync_ = -Stamp(1);
  Stamp earlier_sync_ = -Stamp(1);
  Stamp paired_sync_ = -Stamp(1);
  Stamp last_seen_{};
  Stamp next_poll_{};
  Stamp next_rest_{};
  Stamp give_up_at_ = kNever;
};

}  // namespace slamsensor::hal
