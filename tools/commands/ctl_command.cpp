#include "firmware/config/daemon_config.hpp"
#include "tools/commands/command.hpp"
#include "tools/control/ctl.hpp"

#include <CLI/CLI.hpp>

#include <memory>
#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

struct Options {
  CtlOptions ctl;
  double timeout_s = 60.0;
  std::vector<std::string> words;
};

CommandResult run(const Options& options) {
  auto client = ControlClient::connect(options.ctl.socket);
  if (!client) {
    return tl::unexpected(client.error());
  }
  std::string request;
  for (const std::string& word : options.words) {
    request += (request.empty() ? "" : " ") + word;
  }
  return request.empty() ? run_lines(*client, options.ctl, stdin, stdout)
                         : run_request(*client, request, options.ctl, stdout);
}

}  // namespace

void add_ctl(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  options->ctl.socket = firmware::ControlConfig().socket;
  auto json = std::make_shared<bool>(false);
  CLI::App* verb = app.add_subcommand("ctl",
                                      "ask or command the running daemon; 'ctl help' lists the commands, no "
                                      "command reads them from the input");
  verb->add_option("--socket", options->ctl.socket, "the daemon's control socket")
      ->type_name("PATH")
      ->capture_default_str();
  verb->add_option("--timeout", options->timeout_s, "for one answer, s")
      ->check(CLI::Range(0.1, 3600.0))
      ->check(is_finite)
      ->capture_default_str();
  verb->add_flag("--json", *json, "one line of JSON per command");
  verb->prefix_command();  // what follows is the daemon's, negative numbers among it
  verb->footer("[COMMAND...], for example: status, map save garden, scan now");
  verb->callback([verb, options, json, &result] {
    for (const std::string& word : verb->remaining()) {
      word == "--json" ? void(*json = true) : options->words.push_back(word);
    }
    options->ctl.form = *json ? CtlForm::Json : CtlForm::Text;
    options->ctl.timeout = std::chrono::milliseconds(static_cast<std::int64_t>(options->timeout_s * 1e3));
    result = run(*options);
  });
}

}  // namespace slamsensor::tools
