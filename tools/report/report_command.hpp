#pragma once

#include "tools/commands/command.hpp"

namespace slamsensor::tools {

/// Adds the verb `report`, as the functions of command.hpp add theirs.
void add_report(CLI::App& app, CommandResult& result);

}  // namespace slamsensor::tools
