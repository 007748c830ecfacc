#pragma once

#include "firmware/control/control_request.hpp"
#include "firmware/control/status_report.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace slamsensor::firmware {

/// A daemon that notes what it is asked, answers "done" at once, or later when the test says so.
class FakeControlTarget {
 public:
  enum class Manner { AtOnce, Later, Refusing, Throwing };

  Manner manner = Manner::AtOnce;
  SensorStatus current;
  std::vector<std::string> asked;    ///< "map load shed"
  std::vector<ControlToken> tokens;  ///< of what is to be answered later
  ControlReply reply{"done", {}};

  /// What a server is given; this outlives it.
  [[nodiscard]] ControlHandler handler() {
    return [this](const ControlRequest& request) { return answer(request); };
  }

  ControlOutcome answer(const ControlRequest& request) {
    const std::string_view words = request.verb->words;
    if (words == "help") {
      return control_help(request.name);
    }
    if (words == "version") {
      return ControlReply{"slamsensord 1.2.3", {}};
    }
    const auto shown = [&](const auto& text, const auto& json) {
      return ControlReply{{}, request.form == ReplyForm::Json ? std::vector{json(current)} : text(current)};
    };
    if (words == "status") {
      return shown(status_text, status_json);
    }
    if (words == "fix") {
      return shown(fix_text, fix_json);
    }
    if (words == "counters") {
      return shown(counters_text, counters_json);
    }
    if (words == "devices") {
      return shown(devices_text, devices_json);
    }
    return note(request);
  }

 private:
  ControlOutcome note(const ControlRequest& request) {
    std::string text(request.verb->words);
    for (const std::string& argument : {request.name, request.value}) {
      text += argument.empty() ? "" : ' ' + argument;
    }
    asked.push_back(text);
    switch (manner) {
      case Manner::AtOnce:
        return reply;
      case Manner::Later:
        tokens.push_back(request.token);
        return std::nullopt;
      case Manner::Refusing:
        return tl::unexpected(ControlError{ControlErrorCode::Refused, "not now; wait"});
      case Manner::Throwing:
        break;
    }
    throw std::runtime_error("out of ideas");
  }
};

}  // namespace slamsensor::firmware
