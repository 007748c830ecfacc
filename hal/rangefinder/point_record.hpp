#pragma once

#include "hal/rangefinder/point_laser.hpp"
#include "hal/rangefinder/range_driver.hpp"
#include "hal/rangefinder/rangefinder.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace slamsensor::hal {

inline constexpr std::size_t kPointRecordMax = 48;
inline constexpr std::size_t kPointTerminatorMax = 4;
inline constexpr std::size_t kPointPrefixMax = 8;
inline constexpr std::size_t kPointCodesMax = 16;
inline constexpr std::size_t kPointTextMax = 32;
inline constexpr std::size_t kPointCommandsMax = 8;

/// Finds the records of a point laser in a stream of bytes. After any loss two sound records must follow each
/// other before one counts.
class PointRecords {
 public:
  PointRecords(const PointLaserConfig& config, RangeCounters& counters);
  PointRecords(const PointRecords&) = delete;
  PointRecords& operator=(const PointRecords&) = delete;
  virtual ~PointRecords() = default;

  /// Takes the next byte of the stream; whether a reading was found, which the members below then hold.
  [[nodiscard]] bool push(std::uint8_t byte) noexcept;
  /// What follows does not belong to what came before.
  void interrupt() noexcept;

  /// Judged.
  [[nodiscard]] const Measurement& reading() const noexcept { return reading_; }
  /// Its bytes are the places [begin, end) of the stream.
  [[nodiscard]] std::uint64_t begin() const noexcept { return begin_; }
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }

 protected:
  /// What a byte completed: nothing, a sound record (settled by accept()), or what is none.
  enum class Outcome : std::uint8_t { Nothing, Sound, Unsound };
  [[nodiscard]] virtual Outcome take(std::uint8_t byte) noexcept = 0;
  /// Forgets what is under way; whether there was something.
  virtual bool forget() noexcept = 0;

  void accept(const Measurement& raw, Strength strength, std::size_t bytes, std::size_t bytes_after) noexcept;
  /// `number` as a distance or the code that it is.
  [[nodiscard]] Measurement measured(std::int64_t number, double scale) const noexcept;

  RangeCounters& counters_;

 private:
  RangeConfig range_;
  double unit_m_;
  double offset_m_;
  std::array<PointCode, kPointCodesMax> codes_{};
  std::size_t codes_count_ = 0;
  Measurement reading_;
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t position_ = 0;
  unsigned streak_ = 0;
};

/// For the layout of `config`, which is valid.
[[nodiscard]] std::unique_ptr<PointRecords> make_point_records(const PointLaserConfig& config,
                                                               RangeCounters& counters);

/// A number as an ASCII record writes it.
struct AsciiNumber {
  std::int64_t number = 0;  ///< its digits without the point
  unsigned decimals = 0;
  bool has_point = false;
  bool has_strength = false;
  std::int64_t strength = 0;
};

/// Whether all of `text` is [spaces][sign]digits[.digits][separator digits], read into `into`; at most 12
/// digits each. '\0' is no separator.
[[nodiscard]] bool read_decimal(std::string_view text, char separator, AsciiNumber& into) noexcept;
/// Whether all of `text` is 1 to 8 hexadecimal digits.
[[nodiscard]] bool read_hex(std::string_view text, AsciiNumber& into) noexcept;

}  // namespace slamsensor::hal
