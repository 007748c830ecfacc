#pragma once

#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/rangefinder/laser_machine.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tools {

/// The Benewake rangefinders that share the nine-byte frame.
enum class BenewakeModel : std::uint8_t { Tf03, TfMini, TfMiniPlus, TfMiniS, Tf02 };

enum class Tf03Wire : std::uint8_t { Uart, Can };
enum class Tf03Switch : std::uint8_t { Off = 0, On = 1 };

/// What the commands change (TF03 manual V1.2.2, table 8). A member that only counts after save and restart
/// is marked so.
struct Tf03Parameters {
  std::uint32_t rate_hz = 100;
  Tf03Switch output = Tf03Switch::On;
  std::uint16_t over_range_cm = 18'000;  ///< told when nothing, or something farther, came back; 0: no limit
  std::uint32_t baud = 115200;           ///< restart
  Tf03Wire wire = Tf03Wire::Uart;        ///< restart
  std::uint32_t can_send_id = 0x3;       ///< restart
  std::uint32_t can_receive_id = 0x3003;
  std::uint32_t can_baud = 1'000'000;  ///< restart
  Tf03Switch can_extended = Tf03Switch::Off;
};

/// How an EmulatedTf03 or EmulatedTf03Can is built and set up.
struct Tf03Settings {
  BenewakeModel model = BenewakeModel::Tf03;
  DeviceBegin begin = DeviceBegin::PowerUp;
  Tf03Parameters saved;  ///< in its flash when it is switched on
  OutboxDelays delays;
  double crystal_ppm = 0.0;
  Stamp boot_time = std::chrono::milliseconds(300);
  std::uint32_t transmit_buffer_bytes = 64;
  std::uint64_t seed = 1;

  StrengthModel strength{1.44e6, 3500.0};  ///< 40 for 90 % at 180 m, and for 10 % at 60 m
  double strength_min = 40.0;              ///< below it nothing is told but "no return"
  std::uint16_t strength_of_nothing = 12;
  std::uint16_t strength_of_weak = 30;       ///< while the fault WeakSignal lasts
  std::uint16_t strength_of_blinded = 4000;  ///< while the fault Saturation lasts
  std::uint16_t no_return_cm = 18'000;       ///< of the relatives; the TF03 has over_range_cm
  double temperature_c = 25.0;               ///< told by TFmini Plus and TFmini-S

  std::uint32_t bus_baud = 1'000'000;  ///< of the bus it hangs on; at another rate it is deaf and mute
  std::array<std::uint8_t, 3> version = {2, 2, 1};  ///< 1.2.2, lowest first
};

/// The settings of `model` as it leaves the factory: its code and strength for "no return" among them.
[[nodiscard]] Tf03Settings tf03_settings(BenewakeModel model);

/// Sets the rate that is in its flash; the nearest it knows.
void set_rate(Tf03Settings& settings, double rate_hz);

/// The nearest rate of the form n x 10^k (n 1 to 9, k 0 to 3) or 10,000 Hz.
[[nodiscard]] std::uint32_t nearest_tf03_rate(double rate_hz);

/// What a frame tells: the words of distance and strength, whatever they stand for.
struct Tf03Words {
  std::uint16_t distance = 0;
  std::uint16_t strength = 0;
  bool is_trusted = false;  ///< the TF02 tells it in byte 6
};

/// The words for a sight, by the codes of the model; nothing when the model has no word for an error.
[[nodiscard]] Tf03Words tf03_words(const Tf03Settings& settings, const Tf03Parameters& parameters,
                                   const Sight& sight);

/// The nine bytes 59 59 .. on a UART: distance and strength, two bytes of the model, sum of the others.
void build_tf03_frame(const Tf03Settings& settings, const Tf03Words& words, std::vector<std::uint8_t>& out);

/// The data of a CAN frame: distance, strength, zeros.
void build_tf03_can(const Tf03Words& words, std::vector<std::uint8_t>& out);

/// `body`, which begins with 5A and its length, with its sum behind it.
[[nodiscard]] std::vector<std::uint8_t> with_tf03_sum(std::vector<std::uint8_t> body);

/// Finds commands 5A LEN ID ... SUM between other bytes. One that stops for 100 ms is forgotten.
class Tf03Receiver {
 public:
  /// Takes a byte; the whole command when it completes one whose sum is right.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> push(std::uint8_t byte, Stamp at);

  void clear() { buffer_.clear(); }

  /// Commands with a wrong sum or an impossible length.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> take();

  std::vector<std::uint8_t> buffer_;
  Stamp last_byte_{};
  std::uint64_t refused_ = 0;
};

}  // namespace slamsensor::tools
