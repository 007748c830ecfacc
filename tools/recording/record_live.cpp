#include "tools/recording/record_live.hpp"

#include "tools/control/ctl.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>

namespace slamsensor::tools {
namespace {

// A connection of its own for each: the daemon may close one on which nothing is said.
CommandResult request(const LiveRecording& recording, const std::string& text, std::FILE* out) {
  CtlOptions options;
  options.socket = recording.socket;
  auto client = ControlClient::connect(options.socket);
  if (!client) {
    return tl::unexpected(client.error());
  }
  return run_request(*client, text, options, out);
}

sigset_t block_ends() {
  sigset_t ends;
  sigemptyset(&ends);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    sigaddset(&ends, signal);
  }
  ::sigprocmask(SIG_BLOCK, &ends, nullptr);
  return ends;
}

/// Until one of `ends` comes, or for so long.
void wait_for(const sigset_t& ends, std::optional<double> seconds) {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + std::chrono::duration<double>(seconds.value_or(0.0));
  for (;;) {
    const std::chrono::duration<double> left =
        seconds ? std::chrono::duration<double>(until - Clock::now()) : std::chrono::hours(1);
    if (left.count() <= 0.0) {
      return;
    }
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(left);
    const auto rest = std::chrono::duration_cast<std::chrono::nanoseconds>(left - whole);
    const timespec limit{static_cast<std::time_t>(whole.count()), static_cast<long>(rest.count())};
    if (::sigtimedwait(&ends, nullptr, &limit) > 0) {
      return;
    }
  }
}

}  // namespace

CommandResult record_live(const LiveRecording& recording, std::FILE* out) {
  const sigset_t ends = block_ends();
  const std::string start = "record start" + (recording.name.empty() ? "" : ' ' + recording.name);
  if (auto started = request(recording, start, out); !started || *started != EX_OK) {
    return started;
  }
  std::fflush(out);
  wait_for(ends, recording.seconds);
  return request(recording, "record stop", out);
}

}  // namespace slamsensor::tools
