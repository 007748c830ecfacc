#pragma once

#include "firmware/control/control_protocol.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::firmware {

/// What a request brought.
struct ControlReply {
  std::string summary;             ///< behind OK; may be empty
  std::vector<std::string> lines;  ///< data; a line feed within one begins the next
};

/// Why it brought nothing: what, and what to do, in one line.
struct ControlError {
  ControlErrorCode code = ControlErrorCode::Failed;
  std::string message;
};

using ControlResult = tl::expected<ControlReply, ControlError>;

/// Stands for a request that is answered later. Never given twice.
using ControlToken = std::uint64_t;

/// The answer, or none: it will be given to ControlServer::complete with the token of the request.
using ControlOutcome = std::optional<ControlResult>;

/// As the protocol writes it, all lines with their ends. Control characters become '?'; an answer of more
/// than kControlAnswerMax bytes becomes an error that says so.
[[nodiscard]] std::string answer_text(const ControlResult& result);

}  // namespace slamsensor::firmware
