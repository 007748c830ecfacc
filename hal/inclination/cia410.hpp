#pragma once

#include "hal/inclination/inclinometer.hpp"
#include "hal/init_error.hpp"
#include "hal/pantilt/canopen/sdo_client.hpp"
#include "hal/transport/reopen.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace slamsensor::hal {

/// What a positive longitudinal slope means; the maker's drawing on the housing says it.
enum class LongSlope : std::uint8_t { FrontDown, FrontUp };
/// The same of the lateral slope.
enum class LateralSlope : std::uint8_t { LeftUp, LeftDown };

struct Cia410Config {
  std::string interface = "can0";  ///< of the bus, for messages
  std::uint8_t node = 10;          ///< 1..127
  LongSlope long_slope = LongSlope::FrontDown;
  LateralSlope lateral_slope = LateralSlope::LeftUp;
  double poll_hz = 10.0;  ///< measurements asked for, 0.1..50
};

/// Driver of a two-axis CANopen inclinometer (CiA 410). It reads the resolution (6000h), then asks for both
/// slopes again and again by SDO: the 32-bit ones (6110h, 6120h) where the node has them, else those of 16
/// bits (6010h, 6020h). A slope is the angle of one axis of the node to the horizontal.
///
/// Nothing of the node is set; it is started by NMT once it has said what it is. It is begun again after a
/// boot-up message, an emergency message that reports an error, or silence.
class Cia410Inclinometer final : public Inclinometer {
 public:
  /// Refuses a configuration out of the bounds above. `link` outlives the driver.
  [[nodiscard]] static tl::expected<std::unique_ptr<Cia410Inclinometer>, InitError> create(
      const Cia410Config& config, CanLink& link);

  void step(Stamp now) noexcept override;
  [[nodiscard]] DeviceState state() const noexcept override { return state_; }
  [[nodiscard]] std::string_view problem() const noexcept override;
  [[nodiscard]] std::span<const Counter> counters() const noexcept override;
  [[nodiscard]] std::optional<Inclination> take() noexcept override;
  [[nodiscard]] FixedText<80> model() const noexcept override { return model_; }

 private:
  enum class Step : std::uint8_t { DeviceType, Name, Resolution, Long, Lateral };
  enum class Width : std::uint8_t { Bits32, Bits16 };

  Cia410Inclinometer(const Cia410Config& config, CanLink& link);

  [[nodiscard]] bool link_ready(Stamp now) noexcept;
  void receive(Stamp now) noexcept;
  void on_heartbeat(const CanFrame& frame, Stamp now) noexcept;
  void on_emergency(const CanFrame& frame, Stamp now) noexcept;
  void begin(Stamp at) noexcept;
  void ask(Stamp now) noexcept;
  [[nodiscard]] SdoRequest request() const noexcept;
  void on_result(const SdoResult& result, Stamp now) noexcept;
  void on_type(const SdoResult& result, Stamp now) noexcept;
  void on_resolution(const SdoResult& result, Stamp now) noexcept;
  void on_long(const SdoResult& result, Stamp now) noexcept;
  void on_lateral(const SdoResult& result, Stamp now) noexcept;
  void measure(const SdoResult& lateral, Stamp now) noexcept;
  void fail(DeviceState state, std::string_view what, std::string_view advice, Stamp now) noexcept;

  const Cia410Config config_;
  const std::string title_;
  const CanopenConfig sdo_config_;
  CanLink& link_;
  CanopenCounters counters_{kCanopenEventNames};
  SdoClient sdo_;
  DeviceState state_ = DeviceState::Absent;
  ReopenProblem problem_;
  FixedText<80> model_;
  std::uint32_t epoch_ = 0;
  Step step_ = Step::DeviceType;
  Width width_ = Width::Bits32;
  Stamp next_{};  // request
  double unit_rad_ = 0.0;
  double long_rad_ = 0.0;
  Stamp long_sent_{};
  std::optional<Inclination> measured_;
};

}  // namespace slamsensor::hal
