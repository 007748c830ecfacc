#pragma once

#include "hal/device.hpp"
#include "hal/fixed_text.hpp"
#include "hal/init_error.hpp"
#include "hal/pantilt/pan_tilt.hpp"
#include "hal/pantilt/ptu_axis.hpp"
#include "hal/pantilt/ptu_config.hpp"
#include "hal/pantilt/ptu_exchange.hpp"
#include "hal/pantilt/ptu_startup.hpp"
#include "hal/transport/byte_link.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

namespace slamsensor::hal {

/// Driver of the Directed Perception / FLIR pan-tilt units over their ASCII commands (PTU-46-17.5 and the
/// rest of the D46 family, E-series; PTU-D46 and E-series user's manuals).
///
/// A reported position is delivered only when it fits the move under way and the line has stayed quiet from
/// its reply to the next command (or, on a resting axis, for the drain time).
class PtuDriver final : public PanTilt {
 public:
  /// A driver that starts up at its first step(). Refuses a configuration out of the bounds given in
  /// PtuConfig. `link` outlives the driver.
  [[nodiscard]] static tl::expected<std::unique_ptr<PtuDriver>, InitError> create(const PtuConfig& config,
                                                                                  ByteLink& link);

  void step(Stamp now) noexcept override;
  [[nodiscard]] DeviceState state() const noexcept override { return state_; }
  [[nodiscard]] std::string_view problem() const noexcept override;
  [[nodiscard]] std::string_view remark() const noexcept override { return remark_.view(); }
  [[nodiscard]] std::string_view line_trouble() const noexcept override { return trouble_text_.view(); }
  [[nodiscard]] std::span<const Counter> counters() const noexcept override { return counters_.all(); }

  [[nodiscard]] MoveStatus move(Axis axis, double target_rad, double speed_radps) noexcept override;
  [[nodiscard]] MoveStatus halt() noexcept override;
  [[nodiscard]] const AxisStatus& axis(Axis axis) const noexcept override { return part(axis).status(); }
  [[nodiscard]] const PanTiltInfo& info() const noexcept override { return info_; }
  [[nodiscard]] std::size_t take(std::span<AxisSample> into) noexcept override { return samples_.take(into); }

 private:
  enum class Job : std::uint8_t { None, Halt, Echo, Feedback, Move, Poll };
  struct Pending {
    PtuSighting sighting;
    Axis axis = Axis::Pan;
    Stamp since{};
  };

  PtuDriver(const PtuConfig& config, ByteLink& link);

  [[nodiscard]] PtuAxis& part(Axis axis) noexcept { return axis == Axis::Pan ? pan_ : tilt_; }
  [[nodiscard]] const PtuAxis& part(Axis axis) const noexcept { return axis == Axis::Pan ? pan_ : tilt_; }
  [[nodiscard]] Axis next_poll() const noexcept;

  [[nodiscard]] bool link_ready(Stamp now) noexcept;
  void forget() noexcept;
  void restart(Stamp now, std::string_view why = {}) noexcept;
  void step_starting(Stamp now, const PtuExchange::Notices& notices) noexcept;
  void get_ready(Stamp now) noexcept;
  void step_ready(Stamp now, const PtuExchange::Notices& notices) noexcept;
  void heed_disturbance(Stamp now) noexcept;
  void on_answer(const PtuAnswer& answer, Stamp now) noexcept;
  void on_position(const PtuAnswer& answer, Stamp now) noexcept;
  void believe_pending(Stamp now) noexcept;
  [[nodiscard]] Job due_job(Stamp now) const noexcept;
  void send_job(Job job, Stamp now) noexcept;
  void heed_manner(const PtuExchange::Notices& notices) noexcept;
  void judge_line() noexcept;
  void compose_remark() noexcept;
  [[nodiscard]] FixedText<kRemarkMax> ramp_remark(Axis axis) const noexcept;

  const PtuConfig config_;
  ByteLink& link_;
  PtuCounters counters_{kPtuEventNames};
  PtuSamples samples_;
  PtuExchange exchange_;
  PtuStartup startup_;
  PtuAxis pan_;
  PtuAxis tilt_;
  PanTiltInfo info_;
  DeviceState state_ = DeviceState::Absent;
  std::uint32_t epoch_ = 0;
  bool begun_ = false;
  std::string_view lost_because_;  ///< in the step that left Ready; else empty
  Job job_ = Job::None;            // the command that is out
  std::optional<Pending> pending_;
  std::uint32_t disturbances_ = 0;
  std::uint32_t refused_polls_ = 0;
  bool halt_due_ = false;
  bool echo_due_ = false;  // the echo must be turned off again
  bool feedback_due_ = false;
  std::uint32_t echo_tries_ = 0;  // ED in a row after which the echo was still there; likewise FT
  std::uint32_t feedback_tries_ = 0;
  PtuLineHealth::Trouble trouble_ = PtuLineHealth::Trouble::None;  // as the text says
  Stamp told_lateness_{};
  std::uint64_t told_noise_ = 0;
  std::array<PtuRamp, 2> ramps_{};  // as info() and the remark have them
  std::uint64_t learnt_ = 0;
  FixedText<kRemarkMax> trouble_text_;
  FixedText<kRemarkMax> remark_;
};

}  // namespace slamsensor::hal
