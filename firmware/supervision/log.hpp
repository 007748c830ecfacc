#pragma once

#include "hal/clock.hpp"
#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

[[nodiscard]] constexpr bool is_control(char c) noexcept {
  return static_cast<unsigned char>(c) < 0x20 || c == '\x7f';
}

/// `text` with '?' for every control character and for every byte that is not UTF-8: fit for one line of a
/// log, an answer or a status.
[[nodiscard]] std::string plain_text(std::string_view text);

/// `value` with `decimals` digits behind the point, whatever the locale; -0.0 has no sign. "unknown" when it
/// is not finite.
[[nodiscard]] std::string decimal_text(double value, int decimals);

/// How grave a message is.
enum class LogLevel : std::uint8_t { Error, Warning, Notice, Info, Debug };

inline constexpr std::array<std::string_view, 5> kLogLevelNames = {"error", "warning", "notice", "info",
                                                                   "debug"};

[[nodiscard]] constexpr std::string_view to_string(LogLevel level) noexcept {
  return kLogLevelNames[static_cast<std::size_t>(level)];
}

/// The level of that name; none when there is none.
[[nodiscard]] constexpr std::optional<LogLevel> log_level(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kLogLevelNames.size(); ++i) {
    if (kLogLevelNames[i] == name) {
      return static_cast<LogLevel>(i);
    }
  }
  return std::nullopt;
}

/// How a line of the log begins.
enum class LogStyle : std::uint8_t {
  Plain,    ///< UTC and level, for people
  Journal,  ///< "<N>", journald's priority (sd-daemon(3))
};

/// Journal when file `fd` is journald's as JOURNAL_STREAM says, else Plain.
[[nodiscard]] LogStyle log_style(int fd);

struct LogConfig {
  int fd = 2;
  LogStyle style = LogStyle::Plain;
  LogLevel level = LogLevel::Info;       ///< graver ones and this are written
  std::uint32_t repeats_per_minute = 5;  ///< of messages that differ in nothing but their digits
  hal::Stamp (*now)() noexcept = hal::monotonic_now;
  hal::Stamp (*utc_ahead)() noexcept = hal::realtime_ahead;  ///< UTC minus `now`
};

/// The daemon's log. Any thread may use it but the real-time ones: it takes a lock and writes. It never waits
/// for its reader: a line that cannot be written at once is lost and counted, and the next line that can be
/// written follows one that says how many were.
class Log {
 public:
  explicit Log(const LogConfig& config = {}) : config_(config), level_(config.level) {}

  /// Writes `message`, a line for each of its lines, unless its level is not shown or it came too often: then
  /// it is counted, and "repeated n times" follows when its minute is over.
  void write(LogLevel level, std::string_view message);

  void error(std::string_view message) { write(LogLevel::Error, message); }
  void warning(std::string_view message) { write(LogLevel::Warning, message); }
  void notice(std::string_view message) { write(LogLevel::Notice, message); }
  void info(std::string_view message) { write(LogLevel::Info, message); }
  void debug(std::string_view message) { write(LogLevel::Debug, message); }

  void set_level(LogLevel level);

  /// Lines that could not be written.
  [[nodiscard]] std::uint64_t lost();

  /// Logs the repetitions whose minute is over; the main thread calls it about once a second.
  void tick();
  /// Logs all repetitions; before the end.
  void flush();

 private:
  /// A message of the last minute.
  struct Seen {
    std::uint64_t key = 0;
    hal::Stamp since{};
    std::uint32_t shown = 0;  // 0: this place is free
    std::uint32_t withheld = 0;
    LogLevel level = LogLevel::Info;
    std::string text;
  };

  [[nodiscard]] Seen& place_of(std::uint64_t key, hal::Stamp now);
  void close(Seen& seen);
  void print(LogLevel level, std::string_view message);
  /// False when not all of the line was taken.
  [[nodiscard]] bool print_line(LogLevel level, std::string_view line);

  LogConfig config_;
  std::mutex mutex_;
  LogLevel level_;
  std::array<Seen, 64> seen_;
  std::uint64_t lost_ = 0;
  std::uint64_t told_lost_ = 0;
  bool is_cut_ = false;  // the last line was written in part
};

}  // namespace slamsensor::firmware
