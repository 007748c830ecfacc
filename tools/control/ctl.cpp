#include "tools/control/ctl.hpp"

#include "firmware/control/control_request.hpp"
#include "firmware/supervision/file_descriptor.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cerrno>
#include <cstring>
#include <poll.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::tools {
namespace {

using firmware::ControlErrorCode;
using firmware::kControlErrorNames;

/// An answer that goes beyond what the protocol allows comes from somebody else.
constexpr std::size_t kInputMax = 2 * firmware::kControlAnswerMax;

std::string why_not(int error) {
  switch (error) {
    case ENOENT:
    case ECONNREFUSED:
      return "the daemon is not there; start it (systemctl start slamsensor) or name its socket with "
             "--socket";
    case EACCES:
    case EPERM:
      return "permission denied; join the group of the socket (usermod -aG slamsensor USER, then log in "
             "again) "
             "or use sudo";
    default:
      return std::string(std::strerror(error)) + "; name the daemon's socket with --socket";
  }
}

/// Whether `fd` is ready for `events` before `deadline`.
bool wait_for(int fd, short events, std::chrono::steady_clock::time_point deadline) {
  pollfd state{fd, events, 0};
  for (;;) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    const int ready = ::poll(&state, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready >= 0 || errno != EINTR) {
      return ready > 0;
    }
  }
}

/// The last line of an answer; false when `line` is none.
bool read_end(std::string_view line, ControlAnswer& answer) {
  const auto after = [line](std::string_view word) {
    return line == word || (line.starts_with(word) && line[word.size()] == ' ')
               ? std::optional(line.substr(std::min(word.size() + 1, line.size())))
               : std::nullopt;
  };
  if (const auto summary = after(firmware::kControlOk)) {
    answer.is_ok = true;
    answer.summary = *summary;
    return true;
  }
  const auto error = after(firmware::kControlError);
  if (!error) {
    return false;
  }
  const std::size_t colon = std::min(error->find(':'), error->size());
  answer.code = error->substr(0, colon);
  const std::string_view text = error->substr(std::min(colon + 1, error->size()));
  answer.summary = text.substr(text.starts_with(' ') ? 1 : 0);
  return true;
}

}  // namespace

int exit_status_of(std::string_view code) {
  constexpr std::array<std::pair<ControlErrorCode, int>, kControlErrorNames.size()> kStatuses = {
      {{ControlErrorCode::Syntax, EX_USAGE},
       {ControlErrorCode::Unknown, EX_USAGE},
       {ControlErrorCode::Value, EX_USAGE},
       {ControlErrorCode::Config, EX_CONFIG},
       {ControlErrorCode::NotFound, EX_NOINPUT},
       {ControlErrorCode::Refused, EX_UNAVAILABLE},
       {ControlErrorCode::Failed, EX_SOFTWARE},
       {ControlErrorCode::Busy, EX_TEMPFAIL},
       {ControlErrorCode::Timeout, EX_TEMPFAIL}}};
  for (const auto& [known, status] : kStatuses) {
    if (kControlErrorNames[static_cast<std::size_t>(known)] == code) {
      return status;
    }
  }
  return EX_SOFTWARE;
}

tl::expected<ControlClient, CommandError> ControlClient::connect(const std::string& socket) {
  const auto address = firmware::unix_address(socket);
  if (!address) {
    return tl::unexpected(CommandError{
        "--socket " + socket + ": no path of 1 to " + std::to_string(firmware::kUnixPathMax) + " bytes\n",
        EX_USAGE});
  }
  ControlClient client(firmware::FileDescriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)), socket);
  if (::connect(client.descriptor_.get(), address->get(), address->size) != 0) {
    const int error = errno;
    const bool is_forbidden = error == EACCES || error == EPERM;
    return client.failure(is_forbidden ? EX_NOPERM : EX_UNAVAILABLE, why_not(error));
  }
  return client;
}

tl::expected<ControlAnswer, CommandError> ControlClient::ask(std::string_view request,
                                                             std::chrono::milliseconds timeout) {
  const Deadline deadline = std::chrono::steady_clock::now() + timeout;
  send(std::string(request) + '\n', deadline);
  ControlAnswer answer;
  for (;;) {
    auto line = take_line(deadline);
    if (!line) {
      return tl::unexpected(line.error());
    }
    if (line->starts_with(' ')) {
      answer.lines.push_back(line->substr(1));
    } else if (read_end(*line, answer)) {
      return answer;
    } else {
      return failure(EX_PROTOCOL, "what answers there is no slamsensord");
    }
  }
}

/// A daemon that has closed the connection may have said why: what cannot be sent shows when the answer is
/// read.
void ControlClient::send(std::string_view bytes, Deadline deadline) {
  while (!bytes.empty() && wait_for(descriptor_.get(), POLLOUT, deadline)) {
    const ssize_t count = ::send(descriptor_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && errno != EINTR) {
      return;
    }
    bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  }
}

tl::expected<std::string, CommandError> ControlClient::take_line(Deadline deadline) {
  for (;;) {
    if (const std::size_t end = input_.find('\n'); end != input_.npos) {
      std::string line = input_.substr(0, end);
      input_.erase(0, end + 1);
      return line;
    }
    if (input_.size() > kInputMax) {
      return failure(EX_PROTOCOL, "what answers there is no slamsensord");
    }
    if (!wait_for(descriptor_.get(), POLLIN, deadline)) {
      return failure(EX_TEMPFAIL, "no answer in time; the daemon may be busy or stuck: look at its log");
    }
    std::array<char, 4096> bytes;
    const ssize_t count = ::recv(descriptor_.get(), bytes.data(), bytes.size(), 0);
    if (count > 0) {
      input_.append(bytes.data(), static_cast<std::size_t>(count));
    } else if (count == 0 || errno != EINTR) {
      return failure(EX_UNAVAILABLE, "the daemon has closed the connection; look at its log");
    }
  }
}

tl::unexpected<CommandError> ControlClient::failure(int exit_status, std::string_view what) const {
  return tl::unexpected(
      CommandError{"control socket " + socket_ + ": " + std::string(what) + '\n', exit_status});
}

namespace {

constexpr std::string_view kPrompt = "slamsensor> ";

/// The request as it goes to the daemon: with `json` where the daemon has that.
std::string request_for(std::string_view request, CtlForm form) {
  std::string sent(request);
  if (form == CtlForm::Json) {
    for (const firmware::ControlVerb& verb : firmware::control_verbs()) {
      if (verb.words == request && verb.parse == firmware::parse_json) {
        sent += " json";
      }
    }
  }
  return sent;
}

bool has_own_json(const ControlAnswer& answer) {
  return answer.is_ok && answer.lines.size() == 1 && nlohmann::json::accept(answer.lines.front());
}

void print(std::FILE* out, std::string_view line) {
  std::fwrite(line.data(), 1, line.size(), out);
  std::fputc('\n', out);
}

void print_text(std::FILE* out, const ControlAnswer& answer) {
  for (const std::string& line : answer.lines) {
    print(out, line);
  }
  if (answer.is_ok && (!answer.summary.empty() || answer.lines.empty())) {
    print(out, answer.summary.empty() ? std::string(firmware::kControlOk) : answer.summary);
  }
}

/// Asks and prints what comes; a refusal only as JSON.
tl::expected<ControlAnswer, CommandError> ask(ControlClient& client, std::string_view request,
                                              const CtlOptions& options, std::FILE* out) {
  const std::string sent = request_for(request, options.form);
  auto answer = client.ask(sent, options.timeout);
  if (answer && options.form == CtlForm::Text) {
    print_text(out, *answer);
  } else if (answer) {
    const bool has_own = sent != request && has_own_json(*answer);
    print(out, has_own ? answer->lines.front() : answer_json(request, *answer));
  }
  return answer;
}

CommandError refusal(const ControlAnswer& answer) {
  return {answer.summary + '\n', exit_status_of(answer.code)};
}

/// One line without its end; false at the end of `in`. What is longer than a request may be comes in pieces
/// that together are too long as well.
bool read_line(std::FILE* in, std::string& line) {
  std::array<char, firmware::kControlLineMax + 3> bytes{};
  if (std::fgets(bytes.data(), static_cast<int>(bytes.size()), in) == nullptr) {
    return false;
  }
  line = bytes.data();
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) {
    line.pop_back();
  }
  return true;
}

}  // namespace

std::string answer_json(std::string_view request, const ControlAnswer& answer) {
  nlohmann::ordered_json json;
  json["request"] = request;
  json["ok"] = answer.is_ok;
  json["code"] = answer.is_ok ? nlohmann::ordered_json() : nlohmann::ordered_json(answer.code);
  json["text"] = answer.summary;
  json["lines"] = answer.lines;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

CommandResult run_request(ControlClient& client, std::string_view request, const CtlOptions& options,
                          std::FILE* out) {
  const auto answer = ask(client, request, options, out);
  if (!answer) {
    return tl::unexpected(answer.error());
  }
  return answer->is_ok ? CommandResult(EX_OK) : tl::unexpected(refusal(*answer));
}

CommandResult run_lines(ControlClient& client, const CtlOptions& options, std::FILE* in, std::FILE* out) {
  const bool prompts = ::isatty(::fileno(in)) == 1;
  int status = EX_OK;
  std::string line;
  for (;;) {
    if (prompts) {
      std::fwrite(kPrompt.data(), 1, kPrompt.size(), out);
      std::fflush(out);
    }
    if (!read_line(in, line)) {
      std::fputs(prompts ? "\n" : "", out);
      return status;
    }
    const std::string_view request = firmware::trimmed(line);
    if (request == "quit" || request == "exit") {
      return status;
    }
    if (request.empty() || request.front() == '#') {
      continue;
    }
    const auto answer = ask(client, request, options, out);
    if (!answer) {
      return tl::unexpected(answer.error());
    }
    status = answer->is_ok ? EX_OK : refusal(*answer).exit_status;
    if (!answer->is_ok && options.form == CtlForm::Text) {
      print(out, "refused: " + answer->summary);
    }
    std::fflush(out);
  }
}

}  // namespace slamsensor::tools
