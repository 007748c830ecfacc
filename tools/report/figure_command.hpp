#pragma once

#include "tools/commands/command.hpp"

namespace slamsensor::tools {

/// Adds the verb `figure`, as the functions of command.hpp add theirs.
void add_figure(CLI::App& app, CommandResult& result);

}  // namespace slamsensor::tools
