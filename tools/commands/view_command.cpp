#include "firmware/config/daemon_config.hpp"
#include "firmware/lcm/lcm_sink.hpp"
#include "hal/clock.hpp"
#include "tools/commands/command.hpp"
#include "tools/control/ctl.hpp"
#include "tools/input/text.hpp"
#include "tools/spy/lcm_receiver.hpp"
#include "tools/view/daemon_facts.hpp"
#include "tools/view/view_server.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <poll.h>
#include <string>
#include <thread>
#include <unistd.h>

namespace slamsensor::tools {
namespace {

constexpr std::chrono::milliseconds kWait(100);
constexpr hal::Stamp kJoinAgain = std::chrono::seconds(1);
constexpr int kMessagesAtOnce = 2'000;  // a flood must not keep pages from the story
constexpr std::size_t kTokenMin = 16;
constexpr const char* kMakeToken = "head -c 24 /dev/urandom | base64";
constexpr std::chrono::seconds kAskAgain(2);  // what `ctl datum set` did shows as soon

struct Options {
  ConfigOptions config;
  std::string listen = "127.0.0.1:8210";
  std::string url;
  std::string prefix;
  std::string socket;
  std::filesystem::path token_file;
  std::filesystem::path recording;
};

struct Endpoint {
  std::string address;
  int port = 0;
};

tl::unexpected<CommandError> fail(std::string message, int exit_status) {
  return tl::unexpected(CommandError{std::move(message) + '\n', exit_status});
}

tl::expected<Endpoint, CommandError> endpoint_of(const std::string& listen) {
  const std::size_t colon = listen.rfind(':');
  const auto port =
      colon == std::string::npos ? std::nullopt : parse_integer(std::string_view(listen).substr(colon + 1));
  if (colon == 0 || !port || *port < 0 || *port > 65'535) {
    return fail(
        "--listen: ADDRESS:PORT is needed, such as 127.0.0.1:8210; 0.0.0.0:8210 opens it to the network",
        EX_USAGE);
  }
  std::string address = listen.substr(0, colon);
  if (address.starts_with('[') && address.ends_with(']')) {
    address = address.substr(1, address.size() - 2);
  }
  return Endpoint{address, static_cast<int>(*port)};
}

/// The first line of the file; empty without a file.
tl::expected<std::string, CommandError> read_token(const std::filesystem::path& path) {
  if (path.empty()) {
    return std::string();
  }
  const auto text = read_file(path);
  if (!text) {
    return fail(text.error().message, EX_NOINPUT);
  }
  std::string token(trim(std::string_view(*text).substr(0, text->find('\n'))));
  if (std::any_of(token.begin(), token.end(), [](char c) { return c < ' ' || c > '~'; })) {
    return fail(path.string() + ": a token has only printable ASCII characters; make one: " + kMakeToken,
                EX_DATAERR);
  }
  if (token.size() < kTokenMin) {
    return fail(path.string() + ": the token has " + std::to_string(token.size()) + " characters and needs " +
                    std::to_string(kTokenMin) + "; make one: " + kMakeToken,
                EX_DATAERR);
  }
  return token;
}

/// Asks the daemon, over a connection of its own for each request.
std::string ask_daemon(const std::string& socket, const std::string& request) {
  auto client = ControlClient::connect(socket);
  ControlAnswer answer;
  if (!client) {
    answer.code = "failed";
    answer.summary = std::string(trim(client.error().message));
  } else if (auto said = client->ask(request, std::chrono::seconds(20))) {
    answer = std::move(*said);
  } else {
    answer.code = "failed";
    answer.summary = std::string(trim(said.error().message));
  }
  return answer_json(request, answer);
}

/// Feeds the live story from the network until `stop`.
class Listener {
 public:
  Listener(firmware::LcmUrl url, ViewServer::Live& live)
      : url_(std::move(url)), live_(live), thread_([this](const std::stop_token& stop) { run(stop); }) {}

 private:
  void run(const std::stop_token& stop) {
    std::optional<LcmReceiver> receiver;
    hal::Stamp next = hal::Stamp::min();
    while (!stop.stop_requested()) {
      const hal::Stamp now = hal::monotonic_now();
      if (!receiver && now >= next) {
        next = now + kJoinAgain;
        auto opened = LcmReceiver::open(url_);
        const std::lock_guard lock(live_.mutex);
        live_.problem = opened ? std::string() : opened.error();
        if (opened) {
          receiver.emplace(std::move(*opened));
        }
      }
      pollfd place{receiver ? receiver->fd() : -1, POLLIN, 0};
      ::poll(&place, 1, static_cast<int>(kWait.count()));
      if (receiver) {
        take(*receiver);
      }
    }
  }

  void take(LcmReceiver& receiver) {
    const std::lock_guard lock(live_.mutex);
    for (int i = 0; i < kMessagesAtOnce; ++i) {
      const auto message = receiver.next();
      if (!message) {
        return;
      }
      const auto utc = std::chrono::duration_cast<std::chrono::microseconds>(
          std::chrono::system_clock::now().time_since_epoch());
      live_.story.on_message(message->channel, message->bytes, utc.count());
    }
  }

  firmware::LcmUrl url_;
  ViewServer::Live& live_;
  std::jthread thread_;
};

/// Keeps the live story to the facts of the daemon at `socket` until it is destroyed.
class Inquirer {
 public:
  Inquirer(std::string socket, DaemonFacts configured, ViewServer::Live& live)
      : socket_(std::move(socket)),
        configured_(std::move(configured)),
        live_(live),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

 private:
  void run(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
      const auto facts = ask_facts(socket_);
      {
        const std::lock_guard live_lock(live_.mutex);
        set_facts(facts, configured_, live_.story);
      }
      wake.wait_for(lock, stop, kAskAgain, [] { return false; });
    }
  }

  std::string socket_;
  DaemonFacts configured_;
  ViewServer::Live& live_;
  std::jthread thread_;
};

/// Serves until SIGINT or SIGTERM, which all threads have blocked.
CommandResult serve(ViewServer& server, const Endpoint& at, const sigset_t& signals, const char* what) {
  const auto port = server.bind(at.address, at.port);
  if (!port) {
    return fail(port.error(), EX_UNAVAILABLE);
  }
  const bool is_v6 = at.address.find(':') != std::string::npos;
  std::printf("slamsensor view: http://%s%s%s:%d/ (%s; Ctrl-C ends it)\n", is_v6 ? "[" : "",
              at.address.c_str(), is_v6 ? "]" : "", *port, what);
  std::fflush(stdout);
  std::jthread waiter([&server, &signals] {
    int signal = 0;
    ::sigwait(&signals, &signal);
    server.stop();
  });
  server.run();
  ::kill(::getpid(), SIGTERM);  // if it ended by itself: the waiter too
  return EX_OK;
}

CommandResult show_live(const Options& options, const Endpoint& at, const sigset_t& signals) {
  const auto loaded = load(options.config);
  if (!loaded) {
    return tl::unexpected(loaded.error());
  }
  const firmware::DaemonConfig& daemon = loaded->config.daemon;
  auto url = firmware::resolve_lcm_url(options.url.empty() ? daemon.lcm.url : options.url,
                                       std::getenv("LCM_DEFAULT_URL"));
  if (!url) {
    return fail(url.error().message, EX_USAGE);
  }
  auto token = read_token(options.token_file);
  if (!token) {
    return tl::unexpected(token.error());
  }
  const std::string prefix = options.prefix.empty() ? daemon.lcm.prefix : options.prefix;
  const std::string socket = options.socket.empty() ? daemon.control.socket : options.socket;
  ViewServer::Live live{SensorStory(prefix), {}, {}};
  const bool has_token = !token->empty();
  ViewServer server(
      live, {std::move(*token), [&](const std::string& request) { return ask_daemon(socket, request); }});
  const Listener listener(std::move(*url), live);
  const Inquirer inquirer(socket, {0, loaded->config.datum, daemon.fix.stale_s}, live);
  return serve(server, at, signals, has_token ? "control with the token" : "read-only");
}

CommandResult show_recording(const Options& options, const Endpoint& at, const sigset_t& signals) {
  auto recording = RecordedStory::open(
      options.recording, options.prefix.empty() ? firmware::LcmConfig().prefix : options.prefix);
  if (!recording) {
    return fail(recording.error().message, EX_DATAERR);
  }
  const auto loaded = load(options.config);
  if (!loaded) {
    return tl::unexpected(loaded.error());
  }
  recording->offer_datum(loaded->config.datum);
  if (!recording->warning().empty()) {
    std::fprintf(stderr, "slamsensor: %s\n", recording->warning().c_str());
  }
  ViewServer server(std::move(*recording));
  return serve(server, at, signals, "a recording");
}

CommandResult run(const Options& options) {
  if (!options.recording.empty() && !options.token_file.empty()) {
    return fail("--control-token-file: a recording cannot be controlled; leave it out", EX_USAGE);
  }
  const auto at = endpoint_of(options.listen);
  if (!at) {
    return tl::unexpected(at.error());
  }
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGINT);
  ::sigaddset(&signals, SIGTERM);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  return options.recording.empty() ? show_live(options, *at, signals) : show_recording(options, *at, signals);
}

}  // namespace

void add_view(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("view", "a web page of a sensor on the network, or of a recording");
  verb->add_option("RECORDING", options->recording, "of ctl record, record or lcm-logger; else live");
  options->config.add_to(*verb);
  verb->add_option("--listen", options->listen,
                   "where pages are served; 0.0.0.0:PORT opens it to the network")
      ->type_name("ADDRESS:PORT")
      ->capture_default_str();
  verb->add_option("--url", options->url, "LCM's network; else lcm.url, LCM_DEFAULT_URL, LCM's default")
      ->type_name("udpm://GROUP:PORT");
  verb->add_option("--prefix", options->prefix, "of the sensor's channels; else lcm.prefix");
  verb->add_option("--socket", options->socket, "the daemon's control socket; else control.socket")
      ->type_name("PATH");
  verb->add_option(
          "--control-token-file", options->token_file,
          "its first line, 16 characters or more, lets a page scan, save, freeze and record; without "
          "it pages are read-only")
      ->type_name("FILE");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
