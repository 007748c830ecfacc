#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// `text` in capitals.
[[nodiscard]] std::string upper(std::string_view text);

/// `text` without spaces at its ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The numbers in `text`, separated by spaces; nothing when something else stands there.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(std::string_view text);

}  // namespace slamsensor::tools
