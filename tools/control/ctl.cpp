#include "tools/control/ctl.hpp"

#include "firmware/control/control_request.hpp"
#include "firmware/control/control_words.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cstring>
#include <unistd.h>

namespace slamsensor::tools {
namespace {

constexpr std::string_view kPrompt = "slamsensor> ";

/// The request as it goes to the daemon: with `json` where the daemon has that.
std::string request_for(std::string_view request, CtlForm form) {
  std::string sent(request);
  if (form == CtlForm::Json) {
    for (const firmware::ControlCommand& command : firmware::control_commands()) {
      if (command.words == request && command.arguments == firmware::ControlArguments::OptionalJson) {
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
