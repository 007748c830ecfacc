#include "firmware/supervision/service_notifier.hpp"

#include "firmware/supervision/plain_text.hpp"

#include <charconv>
#include <cstdlib>

namespace slamsensor::firmware {
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

}  // namespace slamsensor::firmware
