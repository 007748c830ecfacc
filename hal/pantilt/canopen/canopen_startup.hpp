#pragma once

#include "hal/pantilt/canopen/canopen_enable.hpp"
#include "hal/pantilt/canopen/canopen_facts.hpp"
#include "hal/pantilt/canopen/canopen_pdo.hpp"
#include "hal/pantilt/canopen/canopen_reference.hpp"

namespace slamsensor::hal {

/// Takes one node from whatever it does to an enabled drive that knows where it stands.
class CanopenStartup {
 public:
  /// All of them outlive this.
  CanopenStartup(const CanopenConfig& config, const CanopenAxisConfig& axis, CanLink& link, SdoClient& sdo,
                 CanopenCounters& counters) noexcept;

  /// Starts over.
  void begin(Stamp now) noexcept;

  /// One step; anything but None means it has failed.
  [[nodiscard]] CanopenProblem step(Stamp now) noexcept;

  [[nodiscard]] bool is_done() const noexcept { return stage_ == Stage::Done; }

  /// Whether the node was told to start: SYNC may now be of use to it.
  [[nodiscard]] bool is_operational() const noexcept { return stage_ >= Stage::Enable; }

  [[nodiscard]] const CanopenFacts& facts() const noexcept { return facts_.facts(); }
  [[nodiscard]] const PdoMap& command_map() const noexcept { return receive_.map(); }
  [[nodiscard]] const PdoMap& position_map() const noexcept { return transmit_.map(); }
  [[nodiscard]] std::int32_t position() const noexcept { return reference_.position(); }
  [[nodiscard]] bool has_heartbeat() const noexcept { return settings_.has_heartbeat(); }

 private:
  enum class Stage : std::uint8_t {
    Stop,
    Facts,
    Settings,
    Receive,
    Transmit,
    Start,
    Enable,
    Reference,
    Done
  };

  [[nodiscard]] CanopenScript* script() noexcept;
  void enter(Stage stage, Stamp now) noexcept;
  void step_nmt(NmtCommand command, Stamp now) noexcept;

  const CanopenConfig& config_;
  const CanopenAxisConfig& axis_;
  CanLink& link_;
  SdoClient& sdo_;
  CanopenCounters& counters_;
  CanopenFactsScript facts_;
  CanopenSettingsScript settings_;
  CanopenPdoScript receive_;
  CanopenPdoScript transmit_;
  CanopenEnableScript enable_;
  CanopenReferenceScript reference_;
  Stage stage_ = Stage::Stop;
  bool nmt_sent_ = false;
  Stamp resume_{};
};

}  // namespace slamsensor::hal
