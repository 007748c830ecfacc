#pragma once

#include "hal/inclination/inclinometer.hpp"
#include "hal/init_error.hpp"
#include "hal/transport/reopen.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::hal {

/// `text` without the white space around it.
[[nodiscard]] std::string_view trim_iio(std::string_view text) noexcept;

/// The number that a file of sysfs holds: decimal, finite, with nothing but white space around it.
[[nodiscard]] std::optional<double> parse_iio_number(std::string_view text) noexcept;

/// Row by row, "a, b, c; d, e, f; g, h, i".
using MountMatrix = std::array<double, 9>;

/// The mount matrix that a file of sysfs holds; nothing unless it is a rotation (rows of unit length, at
/// right angles, right-handed; each within 0.01).
[[nodiscard]] std::optional<MountMatrix> parse_mount_matrix(std::string_view text) noexcept;

struct IioConfig {
  /// "iio:device0", or what the device's file `name` or `label` holds ("adxl345"), which stays when devices
  /// are numbered in another order.
  std::string device = "iio:device0";
  std::string root = "/sys/bus/iio/devices";  ///< where names are looked for
};

enum class IioEvent : std::uint8_t { ReadsFailed, NumbersMalformed, NotAtRest, Reopened };

/// Driver of an accelerometer of the Linux IIO subsystem: at rest its acceleration points up. Reads the files
/// of sysfs (in_accel_{x,y,z}_raw, scale, offset, mount matrix), which may take milliseconds each: not for a
/// real-time thread. After construction no memory is taken.
class IioAccelerometer final : public Inclinometer {
 public:
  /// Refuses a device without a name, or with too long a one.
  [[nodiscard]] static tl::expected<std::unique_ptr<IioAccelerometer>, InitError> create(
      const IioConfig& config);

  ~IioAccelerometer() override { close_all(); }

  void step(Stamp now) noexcept override;
  [[nodiscard]] DeviceState state() const noexcept override { return state_; }
  [[nodiscard]] std::string_view problem() const noexcept override { return problem_.view(); }
  [[nodiscard]] std::span<const Counter> counters() const noexcept override { return counters_.all(); }
  [[nodiscard]] std::optional<Inclination> take() noexcept override;
  [[nodiscard]] FixedText<80> model() const noexcept override { return model_; }

 private:
  using Vector = std::array<double, 3>;

  /// The value of a file of the device.
  struct Axis {
    int raw = -1;  // file descriptor, -1 when closed
    double offset = 0.0;
    double scale = 1.0;
  };

  explicit IioAccelerometer(const IioConfig& config);

  [[nodiscard]] bool find_device() noexcept;
  [[nodiscard]] bool open_axes() noexcept;
  [[nodiscard]] bool read_mount() noexcept;
  [[nodiscard]] std::optional<double> setting(std::string_view axis, std::string_view what,
                                              double absent) noexcept;
  [[nodiscard]] std::optional<Vector> read() noexcept;
  void add(const Vector& acceleration, Stamp now) noexcept;
  void measure(const Vector& mean, Stamp now) noexcept;
  void fail(DeviceState state, std::string_view what, int error, std::string_view advice) noexcept;
  void close_all() noexcept;

  const IioConfig config_;
  DeviceState state_ = DeviceState::Absent;
  ReopenProblem problem_;
  FixedText<80> model_;
  std::array<char, 256> folder_{};
  std::array<Axis, 3> axes_;
  MountMatrix mount_;
  Stamp next_{};
  Vector sum_{};
  std::uint32_t added_ = 0;
  Stamp first_{};  // of the readings in sum_
  bool was_open_ = false;
  std::optional<Inclination> measured_;
  EventCounters<IioEvent, 4> counters_{
      std::array<std::string_view, 4>{"reads_failed", "numbers_malformed", "not_at_rest", "reopened"}};
};

}  // namespace slamsensor::hal
