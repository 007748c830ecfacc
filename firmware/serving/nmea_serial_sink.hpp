#pragma once

#include "firmware/config/daemon_config.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "hal/counters.hpp"
#include "hal/init_error.hpp"
#include "hal/transport/serial_port.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>

namespace slamsensor::firmware {

enum class NmeaSerialEvent : std::uint8_t {
  Opened,       ///< the port came up
  Epochs,       ///< handed to the line
  Bytes,        ///< of them
  DroppedBusy,  ///< epochs lost because the line has not sent what went before
  DroppedDown,  ///< epochs lost while the port was down
  Ignored,      ///< bytes that were written to us, such as gpsd's probes
};

/// Epochs on a serial line. The line sends what it is given even when it is late, so a line that is too slow
/// is not filled up: an epoch is dropped when what went before needs longer than `patience` to leave at the
/// line's rate, which also keeps what a reader gets fresh.
class NmeaSerialSink final : public EpochSink {
 public:
  /// `link` outlives this. `patience` is the period of the regular epochs, at least 100 ms.
  NmeaSerialSink(hal::ByteLink& link, hal::Stamp patience) noexcept;

  /// The same on a port of its own, which need not be there yet. The error names the setting.
  [[nodiscard]] static tl::expected<std::unique_ptr<NmeaSerialSink>, hal::InitError> open(
      const NmeaSerialConfig& config, hal::Stamp patience);

  void set_patience(hal::Stamp patience) noexcept { patience_ = patience; }

  void step(hal::Stamp now) noexcept override;
  void send(std::span<const char> epoch, const OutputTime& now) noexcept override;
  /// Nothing: a reader of NMEA has nothing to say, and step() comes soon enough.
  [[nodiscard]] std::size_t poll_on(std::span<pollfd>) const noexcept override { return 0; }
  [[nodiscard]] std::string_view problem() const noexcept override;
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept override { return counters_.all(); }

 private:
  NmeaSerialSink(std::unique_ptr<hal::SerialPort> port, hal::Stamp patience) noexcept;

  std::unique_ptr<hal::SerialPort> port_;  ///< null on a link that is somebody else's
  hal::ByteLink& link_;
  hal::Stamp patience_;
  hal::Stamp line_free_{};  ///< when all that was written will have left
  std::uint32_t link_epoch_ = 0;
  hal::EventCounters<NmeaSerialEvent, 6> counters_;
};

}  // namespace slamsensor::firmware
