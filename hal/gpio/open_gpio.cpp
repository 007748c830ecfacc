#include "hal/gpio/open_gpio.hpp"

#include "hal/counters.hpp"
#include "hal/gpio/gpio.hpp"
#include "hal/gpio/gpio_line.hpp"
#include "hal/ring.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace slamsensor::hal {
namespace {

constexpr Stamp kDebounceMax = std::chrono::seconds(1);
constexpr Stamp kAheadMax = std::chrono::seconds(1);
constexpr int kEdgesMax = 64;  // read in one call; the kernel keeps 16

enum class Event : std::uint8_t { Edge, EdgeLost, EventDropped, StampRefused, ReadFailed };
constexpr std::array<std::string_view, 5> kNames = {"edges", "edges_lost", "events_dropped", "stamps_refused",
                                                    "read_failed"};

bool wants(GpioEdges edges, GpioEdge edge) noexcept {
  return edges == GpioEdges::Both ||
         edges == (edge == GpioEdge::ToActive ? GpioEdges::ToActive : GpioEdges::ToInactive);
}

/// An input that the kernel debounces, or nobody needs to.
class PlainInput final : public GpioInput {
 public:
  PlainInput(GpioLine line, GpioEdges edges) noexcept
      : line_(std::move(line)), edges_(edges), counters_(kNames) {}

  std::optional<GpioLevel> level(Stamp) noexcept override {
    const std::optional<GpioLevel> level = line_.get();
    counters_.count(Event::ReadFailed, level ? 0 : 1);
    return level;
  }

  std::optional<GpioEvent> next_event(Stamp now) noexcept override {
    std::optional<GpioEvent> event = line_.read();
    if (!event) {
      return std::nullopt;
    }
    counters_.count(Event::Edge);
    if (edges_ == GpioEdges::Both && last_ == event->edge) {
      counters_.count(Event::EdgeLost);
    }
    last_ = event->edge;
    if (event->stamp > now + kAheadMax) {  // before Linux 5.7 the stamps were wall clock time
      counters_.count(Event::StampRefused);
      event->stamp = now;
    }
    return event;
  }

  int fd() const noexcept override { return line_.fd(); }
  std::span<const Counter> counters() const noexcept override { return counters_.all(); }

  void count(Event event) noexcept { counters_.count(event); }

 private:
  GpioLine line_;
  GpioEdges edges_;
  std::optional<GpioEdge> last_;
  EventCounters<Event, kNames.size()> counters_;
};

/// An input that is debounced here. Its line reports both edges.
class DebouncedInput final : public GpioInput {
 public:
  DebouncedInput(GpioLine line, const GpioInputConfig& config, GpioLevel level) noexcept
      : line_(std::move(line), GpioEdges::Both), edges_(config.edges), debouncer_(config.debounce, level) {}

  std::optional<GpioLevel> level(Stamp now) noexcept override {
    if (!line_.level(now)) {
      return std::nullopt;
    }
    follow(now);
    return debouncer_.settled();
  }

  std::optional<GpioEvent> next_event(Stamp now) noexcept override {
    follow(now);
    GpioEvent event;
    return settled_.take(std::span(&event, 1)) == 1 ? std::optional(event) : std::nullopt;
  }

  int fd() const noexcept override { return edges_ == GpioEdges::None ? -1 : line_.fd(); }
  std::span<const Counter> counters() const noexcept override { return line_.counters(); }

 private:
  void follow(Stamp now) noexcept {
    read_edges(now);
    // Bouncing can overrun the kernel's queue, and the edge that was lost may be the last.
    const std::optional<GpioLevel> level = line_.level(now);
    if (level && *level != debouncer_.last() && !read_edges(now)) {
      line_.count(Event::EdgeLost);
      keep(debouncer_.take({edge_to(*level), now}));
    }
    keep(debouncer_.settle(now));
  }

  bool read_edges(Stamp now) noexcept {
    bool any = false;
    for (int i = 0; i < kEdgesMax; ++i) {
      const std::optional<GpioEvent> edge = line_.next_event(now);
      if (!edge) {
        break;
      }
      any = true;
      keep(debouncer_.take(*edge));
    }
    return any;
  }

  void keep(const std::optional<GpioEvent>& event) noexcept {
    if (event && wants(edges_, event->edge) && !settled_.try_push(*event)) {
      line_.count(Event::EventDropped);
    }
  }

  PlainInput line_;
  GpioEdges edges_;
  Debouncer debouncer_;
  Ring<GpioEvent, 16> settled_;
};

class Output final : public GpioOutput {
 public:
  Output(GpioLine line, GpioLevel level) noexcept : line_(std::move(line)), level_(level) {}

  GpioStatus set(GpioLevel level) noexcept override {
    const GpioStatus status = line_.set(level);
    level_ = status == GpioStatus::Ok ? level : level_;
    return status;
  }
  GpioLevel level() const noexcept override { return level_; }

 private:
  GpioLine line_;
  GpioLevel level_;
};

}  // namespace

tl::expected<std::unique_ptr<GpioInput>, InitError> open_gpio_input(const GpioInputConfig& config) {
  if (config.debounce < Stamp{} || config.debounce > kDebounceMax) {
    return tl::unexpected(gpio_error(config.address, "the debounce time must be within 0 to 1 s"));
  }
  const bool debounced_here = config.debounce > Stamp{} && !GpioLine::debounces_in_kernel();
  GpioLineConfig line;
  line.polarity = config.polarity;
  line.bias = config.bias;
  line.edges = debounced_here ? GpioEdges::Both : config.edges;
  line.debounce = config.debounce;
  tl::expected<GpioLine, InitError> opened = GpioLine::open(config.address, line);
  if (!opened) {
    return tl::unexpected(opened.error());
  }
  if (!debounced_here) {
    return std::make_unique<PlainInput>(std::move(*opened), config.edges);
  }
  const GpioLevel level = opened->get().value_or(GpioLevel::Inactive);
  return std::make_unique<DebouncedInput>(std::move(*opened), config, level);
}

tl::expected<std::unique_ptr<GpioOutput>, InitError> open_gpio_output(const GpioOutputConfig& config) {
  GpioLineConfig line;
  line.direction = GpioDirection::Output;
  line.polarity = config.polarity;
  line.initial = config.initial;
  tl::expected<GpioLine, InitError> opened = GpioLine::open(config.address, line);
  if (!opened) {
    return tl::unexpected(opened.error());
  }
  return std::make_unique<Output>(std::move(*opened), config.initial);
}

}  // namespace slamsensor::hal
