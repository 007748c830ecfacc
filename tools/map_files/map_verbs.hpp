#pragma once

#include "tools/commands/command.hpp"

namespace slamsensor::tools {

/// Adds `export` and `import` to the verb `map`; each leaves its result in `result`.
void add_map_export(CLI::App& map, CommandResult& result);
void add_map_import(CLI::App& map, CommandResult& result);

}  // namespace slamsensor::tools
