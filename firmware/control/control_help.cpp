#include "firmware/control/control_request.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

std::string usage(const ControlCommand& command) {
  std::string text(command.words);
  if (!command.arguments_text.empty()) {
    text += ' ';
    text += command.arguments_text;
  }
  return text;
}

}  // namespace

ControlResult control_help(std::string_view about) {
  std::vector<const ControlCommand*> told;
  std::size_t width = 0;
  for (const ControlCommand& command : control_commands()) {
    if (command.words.starts_with(about)) {
      told.push_back(&command);
      width = std::max(width, usage(command).size());
    }
  }
  if (told.empty()) {
    return tl::unexpected(ControlError{ControlErrorCode::NotFound,
                                       "there is no request '" + std::string(about) + "'; help lists all"});
  }
  ControlReply reply;
  for (const ControlCommand* command : told) {
    std::string line = usage(*command);
    line.resize(width + 2, ' ');
    reply.lines.push_back(line + std::string(command->description));
  }
  return reply;
}

}  // namespace slamsensor::firmware
