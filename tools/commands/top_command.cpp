#include "firmware/lcm/lcm_sink.hpp"
#include "hal/clock.hpp"
#include "tools/commands/command.hpp"
#include "tools/spy/lcm_receiver.hpp"
#include "tools/top/canvas.hpp"
#include "tools/top/top_frame.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <poll.h>
#include <string>
#include <unistd.h>

namespace slamsensor::tools {
namespace {

constexpr hal::Stamp kFramePeriod = std::chrono::milliseconds(250);
constexpr hal::Stamp kJoinAgain = std::chrono::seconds(1);
// A flood of messages must not keep the keys from being read.
constexpr int kMessagesPerFrame = 20'000;

struct Options {
  std::string url;
  std::string prefix = "SLAMSENSOR_";
  TopPage page = TopPage::Sensor;
  bool once = false;
  double wait_s = 3.0;
  int width = 110;
  int height = 40;
};

/// Listens to the group as soon as it can be joined.
class Listener {
 public:
  explicit Listener(firmware::LcmUrl url) : url_(std::move(url)) {}

  /// Takes in what has come by `now`.
  void listen(TopState& state, hal::Stamp now) {
    if (!receiver_ && now >= next_) {
      join(state, now);
    }
    for (int i = 0; receiver_ && i < kMessagesPerFrame; ++i) {
      const auto message = receiver_->next();
      if (!message) {
        break;
      }
      state.on_message(*message, now);
    }
    if (receiver_) {
      state.refused = receiver_->refused();
      state.dropped = receiver_->dropped();
    }
  }

  /// Waits until something may have come on the network or, if `keys` is a file descriptor, on the keyboard.
  void wait(int keys, hal::Stamp at_most) const {
    std::array<pollfd, 2> places = {{{keys, POLLIN, 0}, {receiver_ ? receiver_->fd() : -1, POLLIN, 0}}};
    ::poll(places.data(), places.size(),
           static_cast<int>(std::max<std::int64_t>(1, at_most.count() / 1'000'000)));
  }

 private:
  void join(TopState& state, hal::Stamp now) {
    next_ = now + kJoinAgain;
    auto opened = LcmReceiver::open(url_);
    state.problem = opened ? std::string() : opened.error();
    if (opened) {
      receiver_.emplace(std::move(*opened));
    }
  }

  firmware::LcmUrl url_;
  std::optional<LcmReceiver> receiver_;
  hal::Stamp next_{};
};

/// What a person wants to see before it is worth printing.
bool is_complete(const TopState& state) {
  return state.sensor.status().has_value() && state.sensor.pose().has_value();
}

CommandResult show_once(const Options& options, TopState& state, Listener& listener) {
  const hal::Stamp end = state.started + hal::from_seconds(options.wait_s);
  hal::Stamp now = state.started;
  // The page of channels shows rates, which take the whole time.
  while (now < end && (options.page == TopPage::Channels || !is_complete(state))) {
    listener.listen(state, now);
    listener.wait(-1, std::min(end - now, kFramePeriod));
    now = hal::monotonic_now();
  }
  listener.listen(state, now);
  std::fputs(draw_frame(state, options.width, options.height, now).text().c_str(), stdout);
  if (state.channels.channels().empty()) {
    return tl::unexpected(CommandError{"nothing was heard\n", EX_UNAVAILABLE});
  }
  return EX_OK;
}

/// False: the person has had enough.
bool obey(TopKey key, TopState& state) {
  TopChoice& choice = state.choice;
  const auto channels = static_cast<int>(state.channels.channels().size());
  const auto step = [&](int by) {
    choice.first_line = std::max(0, choice.first_line + by);
    const int last = std::max(0, channels - 1);
    choice.channel = static_cast<std::size_t>(std::clamp(static_cast<int>(choice.channel) + by, 0, last));
  };
  switch (key) {
    case TopKey::Quit:
      return false;
    case TopKey::Sensor:
    case TopKey::Counters:
    case TopKey::Channels:
      choice.page = static_cast<TopPage>(static_cast<int>(key) - static_cast<int>(TopKey::Sensor));
      break;
    case TopKey::NextPage:
      choice.page = static_cast<TopPage>((static_cast<int>(choice.page) + 1) % 3);
      break;
    case TopKey::Up:
      step(-1);
      break;
    case TopKey::Down:
      step(1);
      break;
    case TopKey::None:
    case TopKey::Redraw:
      break;
  }
  return true;
}

/// Draws frames until the person ends it; a terminal that is gone ends it too.
CommandResult show_live(TopState& state, Listener& listener) {
  const auto terminal = Terminal::open();
  if (!terminal) {
    return tl::unexpected(CommandError{terminal.error() + '\n', EX_UNAVAILABLE});
  }
  hal::Stamp shown = hal::Stamp::min();
  while (::isatty(STDIN_FILENO) != 0) {
    const hal::Stamp now = hal::monotonic_now();
    listener.listen(state, now);
    bool is_due = shown == hal::Stamp::min() || now - shown >= kFramePeriod;
    for (TopKey key = (*terminal)->next_key(); key != TopKey::None; key = (*terminal)->next_key()) {
      if (!obey(key, state)) {
        return EX_OK;
      }
      is_due = true;
    }
    if (is_due) {
      (*terminal)->show(draw_frame(state, (*terminal)->width(), (*terminal)->height(), now));
      shown = now;
    }
    listener.wait(STDIN_FILENO, kFramePeriod);
  }
  return EX_OK;
}

CommandResult run(const Options& options) {
  auto url = firmware::resolve_lcm_url(options.url, std::getenv("LCM_DEFAULT_URL"));
  if (!url) {
    return tl::unexpected(CommandError{url.error().message + '\n', EX_USAGE});
  }
  TopState state(options.prefix);
  state.choice.page = options.page;
  state.started = hal::monotonic_now();
  Listener listener(std::move(*url));
  const bool has_terminal = ::isatty(STDOUT_FILENO) != 0 && ::isatty(STDIN_FILENO) != 0;
  return options.once || !has_terminal ? show_once(options, state, listener) : show_live(state, listener);
}

void add_options(CLI::App& verb, Options& options) {
  const std::map<std::string, TopPage> pages = {
      {"sensor", TopPage::Sensor}, {"counters", TopPage::Counters}, {"channels", TopPage::Channels}};
  verb.add_option("--url", options.url, "where to listen; else LCM_DEFAULT_URL, else LCM's default")
      ->type_name("udpm://GROUP:PORT");
  verb.add_option("--prefix", options.prefix, "of the sensor's channels (lcm.prefix)")->capture_default_str();
  verb.add_option_function<std::string>(
          "--page", [&options, pages](const std::string& name) { options.page = pages.at(name); },
          "the page to begin with")
      ->check(CLI::IsMember(pages));
  verb.add_flag("--once", options.once, "print one frame as text and end; so without a terminal");
  verb.add_option("--wait", options.wait_s, "how long --once listens, s")
      ->check(CLI::Range(0.0, 3600.0))
      ->check(is_finite)
      ->capture_default_str();
  verb.add_option("--width", options.width, "of the frame of --once")
      ->check(CLI::Range(1, Canvas::kSizeMax))
      ->capture_default_str();
  verb.add_option("--height", options.height, "of the frame of --once")
      ->check(CLI::Range(1, Canvas::kSizeMax))
      ->capture_default_str();
}

}  // namespace

void add_top(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("top", "live view of a sensor on the network, and of every LCM channel there");
  add_options(*verb, *options);
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
