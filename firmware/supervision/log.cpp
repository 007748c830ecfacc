#include "firmware/supervision/log.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <poll.h>
#include <string_view>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace slamsensor::firmware {
namespace {

std::uint8_t byte_at(std::string_view text, std::size_t i) noexcept {
  return static_cast<std::uint8_t>(text[i]);
}

/// Bytes of the UTF-8 character that `text` begins with; 0 when it begins with none (overlong forms,
/// surrogates and numbers beyond Unicode are none).
std::size_t character_size(std::string_view text) noexcept {
  const std::uint8_t lead = byte_at(text, 0);
  const std::size_t size = lead < 0x80   ? 1
                           : lead < 0xC2 ? 0
                           : lead < 0xE0 ? 2
                           : lead < 0xF0 ? 3
                           : lead < 0xF5 ? 4
                                         : 0;
  if (size == 0 || size > text.size()) {
    return 0;
  }
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte_at(text, i) & 0xC0U) != 0x80U) {
      return 0;
    }
  }
  const std::uint8_t second = size > 1 ? byte_at(text, 1) : 0;
  const bool is_impossible = (lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
                             (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F);
  return is_impossible ? 0 : size;
}

}  // namespace

std::string plain_text(std::string_view text) {
  std::string plain;
  plain.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    if (size == 0 || is_control(text.front())) {
      plain += '?';
    } else {
      plain.append(text.substr(0, size));
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return plain;
}

std::string decimal_text(double value, int decimals) {
  if (!std::isfinite(value)) {
    return "unknown";
  }
  std::array<char, 400> digits{};  // the largest double has 309 in front of the point
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals);
  std::string_view text(digits.data(), static_cast<std::size_t>(end.ptr - digits.data()));
  const bool is_zero = text.find_first_not_of("-0.") == text.npos;
  text.remove_prefix(is_zero && text.starts_with('-') ? 1 : 0);
  return std::string(text);
}

namespace {

constexpr hal::Stamp kWindow = std::chrono::minutes(1);
constexpr std::size_t kLineMax = 2000;  // journald cuts lines at 48 KiB; no message of ours is near
constexpr std::array<char, 5> kPriorities = {'3', '4', '5', '6', '7'};  // syslog(3): LOG_ERR to LOG_DEBUG

/// The same for messages that differ in nothing but the digits of their numbers (FNV-1a).
std::uint64_t key_of(LogLevel level, std::string_view message) {
  std::uint64_t hash = 14'695'981'039'346'656'037ULL ^ static_cast<std::uint64_t>(level);
  bool in_number = false;
  for (const char c : message) {
    const bool is_digit = c >= '0' && c <= '9';
    if (!is_digit || !in_number) {
      hash = (hash ^ static_cast<unsigned char>(is_digit ? '0' : c)) * 1'099'511'628'211ULL;
    }
    in_number = is_digit;
  }
  return hash;
}

/// "2026-01-31T12:00:00.123Z "
std::string utc_text(hal::Stamp utc) {
  const auto whole = std::chrono::floor<std::chrono::seconds>(utc);
  const std::time_t time = static_cast<std::time_t>(whole.count());
  std::tm parts{};
  ::gmtime_r(&time, &parts);
  std::array<char, 64> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(utc - whole).count();
  std::snprintf(text.data() + size, text.size() - size, ".%03dZ ", static_cast<int>(milliseconds));
  return text.data();
}

/// Writes as much of `text` as goes without waiting: a pipe that poll() says is writable takes PIPE_BUF
/// bytes, more than a line has. Returns the bytes written.
std::size_t write_now(int fd, std::string_view text) {
  struct stat status {};
  const bool is_socket = ::fstat(fd, &status) == 0 && S_ISSOCK(status.st_mode);
  pollfd state{fd, POLLOUT, 0};
  if (!is_socket && (::poll(&state, 1, 0) != 1 || (state.revents & POLLOUT) == 0)) {
    return 0;
  }
  const ssize_t count = is_socket ? ::send(fd, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL)
                                  : ::write(fd, text.data(), text.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace

LogStyle log_style(int fd) {
  const char* const stream = std::getenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe)
  struct stat status {};
  if (stream == nullptr || ::fstat(fd, &status) != 0) {
    return LogStyle::Plain;
  }
  const std::string own = std::to_string(status.st_dev) + ':' + std::to_string(status.st_ino);
  return own == stream ? LogStyle::Journal : LogStyle::Plain;
}

void Log::set_level(LogLevel level) {
  const std::lock_guard lock(mutex_);
  level_ = level;
}

void Log::write(LogLevel level, std::string_view message) {
  const std::lock_guard lock(mutex_);
  if (level > level_) {
    return;
  }
  Seen& seen = place_of(key_of(level, message), config_.now());
  seen.level = level;
  if (seen.shown < std::max(config_.repeats_per_minute, 1U)) {
    ++seen.shown;
    print(level, message);
  } else {
    ++seen.withheld;
    seen.text = message;
  }
}

Log::Seen& Log::place_of(std::uint64_t key, hal::Stamp now) {
  auto place = std::find_if(seen_.begin(), seen_.end(),
                            [key](const Seen& seen) { return seen.shown > 0 && seen.key == key; });
  if (place != seen_.end() && now - place->since < kWindow) {
    return *place;
  }
  if (place == seen_.end()) {  // the free one, or the oldest
    place = std::min_element(seen_.begin(), seen_.end(), [](const Seen& a, const Seen& b) {
      return a.shown == 0 || b.shown == 0 ? a.shown < b.shown : a.since < b.since;
    });
  }
  close(*place);
  place->key = key;
  place->since = now;
  return *place;
}

void Log::close(Seen& seen) {
  if (seen.withheld > 0) {
    print(seen.level, "repeated " + std::to_string(seen.withheld) + " times more: " + seen.text);
  }
  seen.shown = 0;
  seen.withheld = 0;
  seen.text.clear();
}

void Log::tick() {
  const std::lock_guard lock(mutex_);
  const hal::Stamp now = config_.now();
  for (Seen& seen : seen_) {
    if (seen.shown > 0 && now - seen.since >= kWindow) {
      close(seen);
    }
  }
}

void Log::flush() {
  const std::lock_guard lock(mutex_);
  std::for_each(seen_.begin(), seen_.end(), [this](Seen& seen) { close(seen); });
}

void Log::print(LogLevel level, std::string_view message) {
  if (lost_ > told_lost_ &&
      print_line(LogLevel::Warning, std::to_string(lost_ - told_lost_) +
                                        " lines of this log were lost: its reader does not read")) {
    told_lost_ = lost_;
  }
  while (!message.empty()) {
    const std::size_t end = std::min(message.find('\n'), message.size());
    lost_ += print_line(level, message.substr(0, end)) ? 0 : 1;
    message.remove_prefix(std::min(end + 1, message.size()));
  }
}

bool Log::print_line(LogLevel level, std::string_view line) {
  std::string text = is_cut_ ? "\n" : "";
  if (config_.style == LogStyle::Journal) {
    text += {'<', kPriorities[static_cast<std::size_t>(level)], '>'};
  } else {
    text += utc_text(config_.now() + config_.utc_ahead()) + std::string(to_string(level)) + ": ";
  }
  text += plain_text(line.substr(0, kLineMax)) + '\n';
  const std::size_t written = write_now(config_.fd, text);
  is_cut_ = written > 0 ? written < text.size() : is_cut_;
  return written == text.size();
}

std::uint64_t Log::lost() {
  const std::lock_guard lock(mutex_);
  return lost_;
}

}  // namespace slamsensor::firmware
