#pragma once

#include "tools/eval/evaluation.hpp"

#include <string>

namespace slamsensor::tools {

/// The evaluation for people: a few aligned lines, metres and degrees, the official figures first.
[[nodiscard]] std::string evaluation_text(const Evaluation& evaluation);

/// The evaluation for programs: one JSON object, keys always in the same order, metres and degrees as the
/// keys say, ending in a newline. `first_fix` and `least_squares` are null without a fix that has a true
/// pose; the top level's `wrong_fixes` is the official one.
[[nodiscard]] std::string evaluation_json(const Evaluation& evaluation);

}  // namespace slamsensor::tools
