#include "hal/inclination/iio_accelerometer.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::hal {
namespace {

constexpr double kRotationSlack = 0.01;
constexpr double kGravityShareMax =
    0.03;  // an acceleration that is off 9.81 m/s^2 by more is not that of rest
constexpr Stamp kPollPeriod = std::chrono::milliseconds(50);
constexpr std::uint32_t kReadingsOfMean = 10;  // half a second, in which the noise averages out
constexpr std::string_view kSpace = " \t\r\n";

bool is_rotation(const MountMatrix& m) noexcept {
  const auto row = [&](std::size_t i, std::size_t j) {
    return m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
  };
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      if (!(std::abs(row(i, j) - (i == j ? 1.0 : 0.0)) <= kRotationSlack)) {
        return false;
      }
    }
  }
  const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                             m[2] * (m[3] * m[7] - m[4] * m[6]);
  return determinant > 0.0;
}

}  // namespace

std::string_view trim_iio(std::string_view text) noexcept {
  const std::size_t first = text.find_first_not_of(kSpace);
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::optional<double> parse_iio_number(std::string_view text) noexcept {
  const std::string_view number = trim_iio(text);
  double value = 0.0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<MountMatrix> parse_mount_matrix(std::string_view text) noexcept {
  MountMatrix matrix{};
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    const bool is_last = i + 1 == matrix.size();
    const std::size_t end = is_last ? text.size() : text.find(i % 3 == 2 ? ';' : ',');
    if (end == std::string_view::npos) {
      return std::nullopt;
    }
    const auto number = parse_iio_number(text.substr(0, end));
    if (!number) {
      return std::nullopt;
    }
    matrix[i] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return is_rotation(matrix) ? std::optional(matrix) : std::nullopt;
}

namespace {

constexpr double kGravity_mps2 = 9.80665;
constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
constexpr MountMatrix kAsItIs = {1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr unsigned kDevicesMax = 64;
constexpr Stamp kReopen = std::chrono::seconds(1);

/// What a file of sysfs holds, cut at its first bytes.
struct Content {
  std::array<char, 256> bytes{};
  std::size_t size = 0;
  int error = 0;

  [[nodiscard]] std::string_view text() const noexcept { return {bytes.data(), size}; }
};

Content read_open(int file) noexcept {
  Content content;
  const ssize_t got = ::pread(file, content.bytes.data(), content.bytes.size(), 0);
  content.error = got < 0 ? errno : 0;
  content.size = got < 0 ? 0 : static_cast<std::size_t>(got);
  return content;
}

/// A path in place; empty when it is too long.
class Path {
 public:
  template <typename... Parts>
  explicit Path(const Parts&... parts) noexcept {
    (add(parts), ...);
  }
  [[nodiscard]] const char* c_str() const noexcept { return fits_ ? text_.data() : ""; }

 private:
  void add(std::string_view part) noexcept {
    fits_ = fits_ && part.size() < text_.size() - size_;
    if (fits_) {
      std::copy(part.begin(), part.end(), text_.begin() + static_cast<std::ptrdiff_t>(size_));
      size_ += part.size();
    }
  }
  std::array<char, 512> text_{};
  std::size_t size_ = 0;
  bool fits_ = true;
};

Content read_file(const Path& path) noexcept {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    Content content;
    content.error = errno;
    return content;
  }
  Content content = read_open(file);
  ::close(file);
  return content;
}

}  // namespace

tl::expected<std::unique_ptr<IioAccelerometer>, InitError> IioAccelerometer::create(const IioConfig& config) {
  const auto refuse = [](const std::string& message) { return tl::unexpected(InitError{message}); };
  if (config.device.empty() || config.device.size() > kDeviceNameMax) {
    return refuse("a device of 1 to " + std::to_string(kDeviceNameMax) + " characters is needed");
  }
  return std::unique_ptr<IioAccelerometer>(new IioAccelerometer(config));
}

IioAccelerometer::IioAccelerometer(const IioConfig& config) : config_(config), mount_(kAsItIs) {
  fail(DeviceState::Absent, "is not there", 0, "check inclination.iio_device");
}

std::optional<Inclination> IioAccelerometer::take() noexcept {
  return std::exchange(measured_, std::nullopt);
}

void IioAccelerometer::step(Stamp now) noexcept {
  if (now < next_) {
    return;
  }
  next_ = now + kReopen;
  if (axes_[0].raw < 0) {
    if (!find_device() || !read_mount() || !open_axes()) {
      close_all();
      return;
    }
    counters_.count(IioEvent::Reopened, was_open_ ? 1 : 0);
    was_open_ = true;
    fail(DeviceState::Starting, "is being read", 0, "wait");
  }
  if (const auto acceleration = read()) {
    next_ = now + kPollPeriod;
    add(*acceleration, now);
  } else {
    close_all();
  }
}

bool IioAccelerometer::find_device() noexcept {
  if (config_.device.front() == '/') {
    std::snprintf(folder_.data(), folder_.size(), "%s", config_.device.c_str());
    model_ = FixedText<80>(trim_iio(read_file(Path(folder_.data(), "/name")).text()));
    return true;
  }
  for (unsigned i = 0; i < kDevicesMax; ++i) {
    std::array<char, 32> entry{};
    std::snprintf(entry.data(), entry.size(), "iio:device%u", i);
    const Path folder(config_.root, "/", entry.data());
    const Content name = read_file(Path(folder.c_str(), "/name"));
    const Content label = read_file(Path(folder.c_str(), "/label"));
    if (config_.device == entry.data() || config_.device == trim_iio(name.text()) ||
        config_.device == trim_iio(label.text())) {
      std::snprintf(folder_.data(), folder_.size(), "%s", folder.c_str());
      model_ = FixedText<80>(trim_iio(name.text()));
      return true;
    }
  }
  fail(DeviceState::Absent, "is not there", ENOENT, "load its driver, or correct inclination.iio_device");
  return false;
}

/// A file of the axis, else the one that all share, else `absent`. Nothing, with its problem, when it holds
/// no number.
std::optional<double> IioAccelerometer::setting(std::string_view axis, std::string_view what,
                                                double absent) noexcept {
  for (const Path& path :
       {Path(folder_.data(), "/in_accel_", axis, "_", what), Path(folder_.data(), "/in_accel_", what)}) {
    const Content content = read_file(path);
    if (content.error == ENOENT) {
      continue;
    }
    const auto number = parse_iio_number(content.text());
    if (!number) {
      counters_.count(IioEvent::NumbersMalformed);
      fail(DeviceState::Faulted, "has a scale or offset that is no number", content.error,
           "check its driver");
    }
    return number;
  }
  return absent;
}

bool IioAccelerometer::open_axes() noexcept {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto scale = setting(kAxes[i], "scale", 1.0);
    const auto offset = setting(kAxes[i], "offset", 0.0);
    if (!scale || !offset) {
      return false;
    }
    const Path path(folder_.data(), "/in_accel_", kAxes[i], "_raw");
    axes_[i] = {::open(path.c_str(), O_RDONLY | O_CLOEXEC), *offset, *scale};
    if (axes_[i].raw < 0) {
      fail(DeviceState::Absent, "open in_accel_{x,y,z}_raw", errno, "choose an accelerometer of three axes");
      return false;
    }
  }
  return true;
}

bool IioAccelerometer::read_mount() noexcept {
  mount_ = kAsItIs;
  for (const std::string_view file : {"/in_accel_mount_matrix", "/in_mount_matrix", "/mount_matrix"}) {
    const Content content = read_file(Path(folder_.data(), file));
    if (content.error != 0) {
      continue;
    }
    const auto matrix = parse_mount_matrix(content.text());
    if (!matrix) {
      counters_.count(IioEvent::NumbersMalformed);
      fail(DeviceState::Faulted, "has a mount matrix that is no rotation", 0, "check its device tree");
      return false;
    }
    mount_ = *matrix;
    return true;
  }
  return true;
}

/// The acceleration along the axes of the mount, m/s^2; nothing, with its problem, when it cannot be read.
std::optional<IioAccelerometer::Vector> IioAccelerometer::read() noexcept {
  Vector own{};
  for (std::size_t i = 0; i < own.size(); ++i) {
    const Content content = read_open(axes_[i].raw);
    if (content.error != 0) {
      counters_.count(IioEvent::ReadsFailed);
      fail(DeviceState::Absent, "read", content.error, "check how it is connected");
      return std::nullopt;
    }
    const auto raw = parse_iio_number(content.text());
    if (!raw) {
      counters_.count(IioEvent::NumbersMalformed);
      fail(DeviceState::Faulted, "reports an acceleration that is no number", 0, "check its driver");
      return std::nullopt;
    }
    own[i] = (*raw + axes_[i].offset) * axes_[i].scale;
  }
  Vector turned{};
  for (std::size_t i = 0; i < turned.size(); ++i) {
    turned[i] = mount_[3 * i] * own[0] + mount_[3 * i + 1] * own[1] + mount_[3 * i + 2] * own[2];
  }
  return turned;
}

void IioAccelerometer::add(const Vector& acceleration, Stamp now) noexcept {
  first_ = added_ == 0 ? now : first_;
  std::transform(sum_.begin(), sum_.end(), acceleration.begin(), sum_.begin(), std::plus<>());
  if (++added_ < kReadingsOfMean) {
    return;
  }
  Vector mean = sum_;
  for (double& part : mean) {
    part /= added_;
  }
  sum_ = {};
  added_ = 0;
  measure(mean, now);
}

void IioAccelerometer::measure(const Vector& mean, Stamp now) noexcept {
  const double size_mps2 = std::hypot(mean[0], mean[1], mean[2]);
  if (!(std::abs(size_mps2 - kGravity_mps2) <= kGravityShareMax * kGravity_mps2)) {
    counters_.count(IioEvent::NotAtRest);
    measured_.reset();
    fail(DeviceState::Faulted, "does not measure gravity alone", 0,
         "let the carrier stand still; if it does, calibrate the accelerometer");
    return;
  }
  state_ = DeviceState::Ready;
  problem_ = {};
  measured_ = inclination_of_up(first_ + (now - first_) / 2, mean[0], mean[1], mean[2]);
}

void IioAccelerometer::fail(DeviceState state, std::string_view what, int error,
                            std::string_view advice) noexcept {
  state_ = state;
  problem_ = describe("accelerometer", config_.device, {what, error, advice});
}

void IioAccelerometer::close_all() noexcept {
  for (Axis& axis : axes_) {
    if (axis.raw >= 0) {
      ::close(axis.raw);
    }
    axis = {};
  }
  sum_ = {};
  added_ = 0;
  measured_.reset();
}

}  // namespace slamsensor::hal
