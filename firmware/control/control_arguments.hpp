#pragma once

#include "firmware/control/control_request.hpp"

namespace slamsensor::firmware {

/// Takes what `request.command` allows behind its words off `text` and puts it into `request`; what is left
/// in `text` is too much. The error says which argument is wrong and what is allowed.
[[nodiscard]] tl::expected<void, ControlError> parse_arguments(std::string_view& text,
                                                               ControlRequest& request);

}  // namespace slamsensor::firmware
