#pragma once

#include <tl/expected.hpp>

#include <string>
#include <sysexits.h>

namespace CLI {
class App;
}

namespace slamsensor::tools {

/// Why a verb failed: one or more lines for the user, and the exit status that scripts see (sysexits).
struct CommandError {
  std::string message;
  int exit_status = EX_SOFTWARE;
};

/// What a verb returns: its exit status.
using CommandResult = tl::expected<int, CommandError>;

/// Each adds its verb to `app`; the verb runs when it is parsed and leaves its result in `result`.
void add_replay(CLI::App& app, CommandResult& result);
void add_locate(CLI::App& app, CommandResult& result);
void add_eval(CLI::App& app, CommandResult& result);
void add_simulate(CLI::App& app, CommandResult& result);
void add_demo(CLI::App& app, CommandResult& result);
void add_emulate(CLI::App& app, CommandResult& result);
void add_record(CLI::App& app, CommandResult& result);
void add_top(CLI::App& app, CommandResult& result);
void add_view(CLI::App& app, CommandResult& result);
void add_map(CLI::App& app, CommandResult& result);
void add_ctl(CLI::App& app, CommandResult& result);
void add_edges(CLI::App& app, CommandResult& result);
void add_memory(CLI::App& app, CommandResult& result);
void add_check_config(CLI::App& app, CommandResult& result);

}  // namespace slamsensor::tools
