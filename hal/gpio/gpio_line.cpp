#include "hal/gpio/gpio_line.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <gpiod.h>
#include <utility>

// The only file that sees libgpiod, whose versions 1 and 2 have nothing but the name in common.

namespace slamsensor::hal {
namespace {

std::string advice_for(int error) {
  switch (error) {
    case ENOENT:
      return "; correct the chip or line in the configuration (gpioinfo lists them)";
    case EACCES:
    case EPERM:
      return "; let this user use the chip (group gpio or a udev rule)";
    case ENOTTY:
    case ENODEV:
      return "; this is no GPIO chip";
    case EINVAL:
      return "; the chip cannot do what is configured (bias, edges or debounce)";
    default:
      return {};
  }
}

}  // namespace

std::optional<unsigned int> offset_of(const GpioAddress& address) noexcept {
  const char* const end = address.line.data() + address.line.size();
  unsigned int offset = 0;
  const auto [stop, problem] = std::from_chars(address.line.data(), end, offset);
  if (problem != std::errc{} || stop != end) {
    return std::nullopt;
  }
  return offset;
}

InitError gpio_error(const GpioAddress& address, std::string_view what) {
  return {"GPIO line " + address.line + " of " + address.chip + ": " + std::string(what)};
}

InitError gpio_failure(const GpioAddress& address, std::string_view step, int error) {
  return gpio_error(address, std::string(step) + ": " + std::strerror(error) + advice_for(error));
}

InitError gpio_busy(const GpioAddress& address, const char* owner) {
  const bool is_known = owner != nullptr && *owner != '\0';
  const std::string who = is_known ? "\"" + std::string(owner) + "\"" : "the kernel or another program";
  return gpio_error(address, "in use by " + who + "; free it or configure another line");
}

namespace {

constexpr const char* kConsumer = "slamsensor";

template <typename T, void (*kRelease)(T*)>
struct Release {
  void operator()(T* object) const noexcept { kRelease(object); }
};
template <typename T, void (*kRelease)(T*)>
using Owned = std::unique_ptr<T, Release<T, kRelease>>;

using Chip = Owned<gpiod_chip, gpiod_chip_close>;

/// Makes reads fail instead of wait.
bool never_waits(int fd) noexcept {
  const int flags = ::fcntl(fd, F_GETFL);
  return flags >= 0 && ::fcntl(fd, F_SETFL, flags | O_NONBLOCK) == 0;
}

}  // namespace

#if SLAMSENSOR_LIBGPIOD_MAJOR >= 2

namespace {

using Settings = Owned<gpiod_line_settings, gpiod_line_settings_free>;
using Lines = Owned<gpiod_line_config, gpiod_line_config_free>;
using Info = Owned<gpiod_line_info, gpiod_line_info_free>;
using RequestConfig = Owned<gpiod_request_config, gpiod_request_config_free>;
using Request = Owned<gpiod_line_request, gpiod_line_request_release>;
using Events = Owned<gpiod_edge_event_buffer, gpiod_edge_event_buffer_free>;

gpiod_line_bias bias_of(GpioBias bias) noexcept {
  switch (bias) {
    case GpioBias::Disabled:
      return GPIOD_LINE_BIAS_DISABLED;
    case GpioBias::PullUp:
      return GPIOD_LINE_BIAS_PULL_UP;
    case GpioBias::PullDown:
      return GPIOD_LINE_BIAS_PULL_DOWN;
    case GpioBias::AsIs:
      break;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

gpiod_line_edge edges_of(GpioEdges edges) noexcept {
  switch (edges) {
    case GpioEdges::ToActive:
      return GPIOD_LINE_EDGE_RISING;
    case GpioEdges::ToInactive:
      return GPIOD_LINE_EDGE_FALLING;
    case GpioEdges::Both:
      return GPIOD_LINE_EDGE_BOTH;
    case GpioEdges::None:
      break;
  }
  return GPIOD_LINE_EDGE_NONE;
}

gpiod_line_value value_of(GpioLevel level) noexcept {
  return level == GpioLevel::Active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

bool put(gpiod_line_settings* settings, const GpioLineConfig& config) noexcept {
  gpiod_line_settings_set_active_low(settings, config.polarity == GpioPolarity::ActiveLow);
  if (config.direction == GpioDirection::Output) {
    return gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_OUTPUT) == 0 &&
           gpiod_line_settings_set_output_value(settings, value_of(config.initial)) == 0;
  }
  const auto debounce = std::chrono::ceil<std::chrono::microseconds>(config.debounce);
  gpiod_line_settings_set_debounce_period_us(settings, static_cast<unsigned long>(debounce.count()));
  return gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_INPUT) == 0 &&
         gpiod_line_settings_set_bias(settings, bias_of(config.bias)) == 0 &&
         gpiod_line_settings_set_edge_detection(settings, edges_of(config.edges)) == 0 &&
         gpiod_line_settings_set_event_clock(settings, GPIOD_LINE_CLOCK_MONOTONIC) == 0;
}

/// Null, and errno says why, when the line could not be had.
Request request(gpiod_chip* chip, unsigned int offset, const GpioLineConfig& config) noexcept {
  const Settings settings(gpiod_line_settings_new());
  const Lines lines(gpiod_line_config_new());
  const RequestConfig how(gpiod_request_config_new());
  if (settings == nullptr || lines == nullptr || how == nullptr || !put(settings.get(), config) ||
      gpiod_line_config_add_line_settings(lines.get(), &offset, 1, settings.get()) != 0) {
    return nullptr;
  }
  gpiod_request_config_set_consumer(how.get(), kConsumer);
  return Request(gpiod_chip_request_lines(chip, how.get(), lines.get()));
}

}  // namespace

struct GpioLine::Handle {
  Request request;
  Events events;
  unsigned int offset;
  Stamp debounce;
};

tl::expected<GpioLine, InitError> GpioLine::open(const GpioAddress& address, const GpioLineConfig& config) {
  const Chip chip(gpiod_chip_open(address.chip.c_str()));
  if (chip == nullptr) {
    return tl::unexpected(gpio_failure(address, "open the chip", errno));
  }
  const int named = gpiod_chip_get_line_offset_from_name(chip.get(), address.line.c_str());
  const unsigned int offset = offset_of(address).value_or(static_cast<unsigned int>(named));
  const Info info(gpiod_chip_get_line_info(chip.get(), offset));
  if (info == nullptr) {
    return tl::unexpected(gpio_failure(address, "find the line", errno == EINVAL ? ENOENT : errno));
  }
  Request taken = request(chip.get(), offset, config);
  if (taken == nullptr) {
    return tl::unexpected(errno == EBUSY ? gpio_busy(address, gpiod_line_info_get_consumer(info.get()))
                                         : gpio_failure(address, "request", errno));
  }
  Events events(gpiod_edge_event_buffer_new(1));
  const int fd = gpiod_line_request_get_fd(taken.get());
  if (events == nullptr || !never_waits(fd)) {
    return tl::unexpected(gpio_failure(address, "set up", errno));
  }
  const bool has_edges = config.edges != GpioEdges::None;
  return GpioLine(
      std::make_unique<Handle>(Handle{std::move(taken), std::move(events), offset, config.debounce}),
      has_edges ? fd : -1);
}

bool GpioLine::debounces_in_kernel() noexcept {
  return true;
}

std::optional<GpioLevel> GpioLine::get() noexcept {
  switch (gpiod_line_request_get_value(handle_->request.get(), handle_->offset)) {
    case GPIOD_LINE_VALUE_ACTIVE:
      return GpioLevel::Active;
    case GPIOD_LINE_VALUE_INACTIVE:
      return GpioLevel::Inactive;
    default:
      return std::nullopt;
  }
}

GpioStatus GpioLine::set(GpioLevel level) noexcept {
  const int failed = gpiod_line_request_set_value(handle_->request.get(), handle_->offset, value_of(level));
  return failed == 0 ? GpioStatus::Ok : GpioStatus::Failed;
}

std::optional<GpioEvent> GpioLine::read() noexcept {
  if (fd_ < 0 || gpiod_line_request_read_edge_events(handle_->request.get(), handle_->events.get(), 1) != 1) {
    return std::nullopt;
  }
  gpiod_edge_event* const event = gpiod_edge_event_buffer_get_event(handle_->events.get(), 0);
  const bool rising = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
  // The kernel stamps a debounced edge when it lets it pass, that is after the debounce time.
  const Stamp stamp(static_cast<Stamp::rep>(gpiod_edge_event_get_timestamp_ns(event)));
  return GpioEvent{rising ? GpioEdge::ToActive : GpioEdge::ToInactive, stamp - handle_->debounce};
}

#else

namespace {

int type_of(const GpioLineConfig& config) noexcept {
  if (config.direction == GpioDirection::Output) {
    return GPIOD_LINE_REQUEST_DIRECTION_OUTPUT;
  }
  switch (config.edges) {
    case GpioEdges::ToActive:
      return GPIOD_LINE_REQUEST_EVENT_RISING_EDGE;
    case GpioEdges::ToInactive:
      return GPIOD_LINE_REQUEST_EVENT_FALLING_EDGE;
    case GpioEdges::Both:
      return GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES;
    case GpioEdges::None:
      break;
  }
  return GPIOD_LINE_REQUEST_DIRECTION_INPUT;
}

int flags_of(const GpioLineConfig& config) noexcept {
  const int polarity = config.polarity == GpioPolarity::ActiveLow ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (config.direction == GpioDirection::Output) {
    return polarity;
  }
  switch (config.bias) {
    case GpioBias::Disabled:
      return polarity | GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
    case GpioBias::PullUp:
      return polarity | GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case GpioBias::PullDown:
      return polarity | GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    case GpioBias::AsIs:
      break;
  }
  return polarity;
}

}  // namespace

struct GpioLine::Handle {
  Chip chip;
  gpiod_line* line;  // the chip's; released with it
};

tl::expected<GpioLine, InitError> GpioLine::open(const GpioAddress& address, const GpioLineConfig& config) {
  Chip chip(gpiod_chip_open(address.chip.c_str()));
  if (chip == nullptr) {
    return tl::unexpected(gpio_failure(address, "open the chip", errno));
  }
  const std::optional<unsigned int> offset = offset_of(address);
  gpiod_line* const line = offset ? gpiod_chip_get_line(chip.get(), *offset)
                                  : gpiod_chip_find_line(chip.get(), address.line.c_str());
  if (line == nullptr) {
    return tl::unexpected(gpio_failure(address, "find the line", errno == EINVAL ? ENOENT : errno));
  }
  const gpiod_line_request_config how{kConsumer, type_of(config), flags_of(config)};
  if (gpiod_line_request(line, &how, config.initial == GpioLevel::Active ? 1 : 0) != 0) {
    return tl::unexpected(errno == EBUSY ? gpio_busy(address, gpiod_line_consumer(line))
                                         : gpio_failure(address, "request", errno));
  }
  const bool has_edges = config.direction == GpioDirection::Input && config.edges != GpioEdges::None;
  const int fd = has_edges ? gpiod_line_event_get_fd(line) : -1;
  if (has_edges && !never_waits(fd)) {
    return tl::unexpected(gpio_failure(address, "set up", errno));
  }
  return GpioLine(std::make_unique<Handle>(Handle{std::move(chip), line}), fd);
}

bool GpioLine::debounces_in_kernel() noexcept {
  return false;
}

std::optional<GpioLevel> GpioLine::get() noexcept {
  const int value = gpiod_line_get_value(handle_->line);
  if (value < 0) {
    return std::nullopt;
  }
  return value != 0 ? GpioLevel::Active : GpioLevel::Inactive;
}

GpioStatus GpioLine::set(GpioLevel level) noexcept {
  const int failed = gpiod_line_set_value(handle_->line, level == GpioLevel::Active ? 1 : 0);
  return failed == 0 ? GpioStatus::Ok : GpioStatus::Failed;
}

std::optional<GpioEvent> GpioLine::read() noexcept {
  gpiod_line_event event{};
  if (fd_ < 0 || gpiod_line_event_read_fd(fd_, &event) != 0) {
    return std::nullopt;
  }
  const bool rising = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE;
  return GpioEvent{rising ? GpioEdge::ToActive : GpioEdge::ToInactive,
                   std::chrono::seconds(event.ts.tv_sec) + Stamp(event.ts.tv_nsec)};
}

#endif

GpioLine::GpioLine(std::unique_ptr<Handle> handle, int fd) noexcept : handle_(std::move(handle)), fd_(fd) {
}

GpioLine::GpioLine(GpioLine&&) noexcept = default;
GpioLine& GpioLine::operator=(GpioLine&&) noexcept = default;
GpioLine::~GpioLine() = default;

}  // namespace slamsensor::hal
