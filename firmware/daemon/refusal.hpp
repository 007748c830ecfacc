#pragma once

#include "firmware/control/control_answer.hpp"
#include "firmware/store/store_error.hpp"

#include <tl/expected.hpp>

#include <string>

namespace slamsensor::firmware {

/// A request that is refused: why, and what to do.
[[nodiscard]] tl::unexpected<ControlError> refusal(ControlErrorCode code, std::string text);
/// The same for what the store refused.
[[nodiscard]] tl::unexpected<ControlError> refusal(const StoreError& error);

}  // namespace slamsensor::firmware
