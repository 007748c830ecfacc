#include "firmware/control/control_session.hpp"

#include <algorithm>
#include <exception>

namespace slamsensor::firmware {
namespace {

ControlResult too_long() {
  return tl::unexpected(ControlError{
      ControlErrorCode::Syntax,
      "the line is longer than " + std::to_string(kControlLineMax) + " bytes; send shorter ones"});
}

/// What the handler throws costs the request, not the daemon.
ControlOutcome carry_out(const ControlRequest& request, const ControlHandler& handler) {
  try {
    return handler(request);
  } catch (const std::exception& error) {
    return tl::unexpected(
        ControlError{ControlErrorCode::Failed,
                     std::string(error.what()) + "; this is a fault of the program, please report it"});
  }
}

}  // namespace

void ControlSession::receive(std::string_view bytes) {
  input_ += bytes.substr(0, room());
}

bool ControlSession::take_line(std::string& line, SessionCounts& counts) {
  while (!input_.empty()) {
    const std::size_t end = input_.find('\n');
    const bool is_whole = end != input_.npos || input_ended_;
    const std::size_t size = std::min(end, input_.size());
    const bool is_cut = skipping_;
    if (!is_whole && size <= kControlLineMax + 1) {  // a carriage return may be its last byte
      input_.erase(0, is_cut ? size : 0);
      return false;
    }
    line = input_.substr(0, size);
    input_.erase(0, end == input_.npos ? size : size + 1);
    skipping_ = !is_whole;
    if (!line.empty() && line.back() == '\r') {
      line.pop_back();
    }
    if (is_cut) {
      continue;
    }
    if (!is_whole || line.size() > kControlLineMax) {
      ++counts.too_long;
      ++counts.refused;
      put(too_long());
      line.clear();
    }
    return true;
  }
  return false;
}

bool ControlSession::can_run() const noexcept {
  return !is_pending() && output_.empty() && !input_.empty() &&
         (input_ended_ || input_.size() > kControlLineMax + 1 || input_.find('\n') != input_.npos);
}

void ControlSession::run(const ControlHandler& handler, ControlToken& last_token, SessionCounts& counts) {
  std::string line;
  while (!is_pending() && output_.empty() && take_line(line, counts)) {
    const std::string_view request = trimmed(line);
    if (!request.empty() && request.front() != '#') {
      answer(request, handler, last_token, counts);
    }
  }
}

void ControlSession::answer(std::string_view line, const ControlHandler& handler, ControlToken& last_token,
                            SessionCounts& counts) {
  ++counts.requests;
  auto request = parse_control_request(line);
  if (!request) {
    ++counts.refused;
    put(tl::unexpected(request.error()));
    return;
  }
  // Waited for before it is asked for: the handler may complete it within the call.
  const ControlToken token = ++last_token;
  pending_ = request->token = token;
  if (const ControlOutcome outcome = carry_out(*request, handler)) {
    counts.refused += outcome->has_value() ? 0 : 1;
    complete(token, *outcome);
  }
}

bool ControlSession::complete(ControlToken token, const ControlResult& result) {
  if (token == kNone || token != pending_) {
    return false;
  }
  pending_ = kNone;
  put(result);
  return true;
}

void ControlSession::give_up(std::string_view why) {
  complete(pending_, tl::unexpected(ControlError{ControlErrorCode::Timeout, std::string(why)}));
}

void ControlSession::put(const ControlResult& result) {
  output_ += answer_text(result);
}

void ControlSession::sent(std::size_t count) noexcept {
  output_sent_ += count;
  if (output_sent_ >= output_.size()) {
    output_.clear();
    output_sent_ = 0;
  }
}

}  // namespace slamsensor::firmware
