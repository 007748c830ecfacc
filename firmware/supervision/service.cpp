#include "firmware/supervision/service.hpp"

#include "firmware/supervision/log.hpp"

#include <charconv>
#include <cstdlib>

namespace slamsensor::firmware {

std::optional<std::size_t> Heartbeats::add(const Thread& thread) noexcept {
  if (size_ == kThreadsMax) {
    return std::nullopt;
  }
  watched_[size_].thread = thread;
  return size_++;
}

std::optional<Heartbeats::Stalled> Heartbeats::check(hal::Stamp now) noexcept {
  std::optional<Stalled> worst;
  hal::Stamp worst_excess{};
  for (std::size_t i = 0; i < size_; ++i) {
    Watched& watched = watched_[i];
    const std::uint64_t count = beats_[i].count.load(std::memory_order_relaxed);
    if (count != watched.count || watched.changed == -hal::kNever) {
      watched.count = count;
      watched.changed = now;
    }
    const hal::Stamp silence = now - watched.changed;
    const hal::Stamp excess = silence - watched.thread.silence_max;
    if (excess > worst_excess) {
      worst_excess = excess;
      worst = Stalled{watched.thread.name, silence};
    }
  }
  return worst;
}

namespace {

constexpr std::int64_t kWatchdogMax_us = std::int64_t{86'400} * 1'000'000;

std::optional<std::int64_t> number_of(const char* name) {
  const char* const text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): before any thread starts
  std::int64_t number = 0;
  const std::string_view digits = text == nullptr ? "" : text;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool is_number = !digits.empty() && end.ec == std::errc() && end.ptr == digits.data() + digits.size();
  return is_number ? std::optional(number) : std::nullopt;
}

std::optional<hal::Stamp> watchdog_from_environment() {
  const auto period_us = number_of("WATCHDOG_USEC");
  const bool is_for_another =
      std::getenv("WATCHDOG_PID") != nullptr && number_of("WATCHDOG_PID") != ::getpid();  // NOLINT
  if (!period_us || *period_us <= 0 || *period_us > kWatchdogMax_us || is_for_another) {
    return std::nullopt;
  }
  return std::chrono::microseconds(*period_us);
}

std::string microseconds_text(hal::Stamp time) {
  return std::to_string(std::chrono::duration_cast<std::chrono::microseconds>(time).count());
}

}  // namespace

ServiceNotifier ServiceNotifier::from_environment() {
  ServiceNotifier notifier;
  const char* const name = std::getenv("NOTIFY_SOCKET");  // NOLINT(concurrency-mt-unsafe)
  const auto address = unix_address(name == nullptr ? "" : name);
  if (address && (*name == '/' || *name == '@')) {
    notifier.address_ = *address;
    notifier.socket_ = FileDescriptor(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  }
  notifier.watchdog_ = watchdog_from_environment();
  return notifier;
}

void ServiceNotifier::reloading(hal::Stamp now) {
  send("RELOADING=1\nMONOTONIC_USEC=" + microseconds_text(now));
}

void ServiceNotifier::extend_timeout(hal::Stamp by) {
  send("EXTEND_TIMEOUT_USEC=" + microseconds_text(by));
}

void ServiceNotifier::status(std::string_view line) {
  std::string plain = plain_text(line);
  if (plain != status_ && send("STATUS=" + plain)) {
    status_ = std::move(plain);
  }
}

bool ServiceNotifier::send(std::string_view message) noexcept {
  if (!socket_) {
    return false;
  }
  const bool is_sent = ::sendto(socket_.get(), message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                                address_.get(), address_.size) == static_cast<ssize_t>(message.size());
  unsent_ += is_sent ? 0 : 1;
  return is_sent;
}

std::optional<Heartbeats::Stalled> Watchdog::step(hal::Stamp now) {
  const auto stalled = heartbeats_.check(now);
  const auto period = notifier_.watchdog_period();
  if (!stalled && period && (!fed_ || now - *fed_ >= *period / 3)) {
    notifier_.feed_watchdog();
    fed_ = now;
  }
  return stalled;
}

}  // namespace slamsensor::firmware
