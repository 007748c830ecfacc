#include "firmware/control/control_server.hpp"
#include "tests/unit/firmware/control/fake_control_target.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace {

using namespace slamsensor::firmware;  // NOLINT(google-build-using-namespace)

/// Every line of an answer is data with a blank in front, or one of the two ends; no line holds a control
/// character.
void check_answers(std::string_view answers) {
  while (!answers.empty()) {
    const std::size_t end = answers.find('\n');
    if (end == answers.npos) {
      __builtin_trap();
    }
    const std::string_view line = answers.substr(0, end);
    const bool is_end = line == "OK" || line.starts_with("OK ") || line.starts_with("ERROR ");
    if ((!line.starts_with(' ') && !is_end) || std::any_of(line.begin(), line.end(), [](char c) {
          return static_cast<unsigned char>(c) < ' ' || c == '\x7f';
        })) {
      __builtin_trap();
    }
    answers.remove_prefix(end + 1);
  }
}

/// Takes what the session has to say until it stands still.
std::size_t run(ControlSession& session, FakeControlTarget& target, ControlToken& token,
                SessionCounts& counts) {
  std::size_t answers = 0;
  do {
    session.run(target.handler(), token, counts);
    const std::string_view output = session.output();
    check_answers(output);
    answers += output.empty() ? 0 : 1;  // no more than one is made ahead
    session.sent(output.size());
    if (session.is_pending()) {
      session.complete(token, ControlReply{"later", {"data"}});
    }
  } while (session.can_run() || !session.output().empty());
  return answers;
}

}  // namespace

// Whatever comes in whatever pieces, memory stays within its bound, every answer is one of the protocol, and
// at the end of the input nothing is left unanswered. The first byte chooses the pieces and how the daemon
// answers.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  FakeControlTarget target;
  target.manner = static_cast<FakeControlTarget::Manner>(data[0] & 3);
  const std::size_t piece = 1 + static_cast<std::size_t>(data[0] >> 2) * 40;
  std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  ControlSession session;
  ControlToken token = 0;
  SessionCounts counts;
  std::size_t answers = 0;
  while (!rest.empty()) {
    const std::size_t taken = std::min({piece, rest.size(), session.room()});
    if (taken == 0) {  // everything was answered, so there must be room
      __builtin_trap();
    }
    session.receive(rest.substr(0, taken));
    rest.remove_prefix(taken);
    answers += run(session, target, token, counts);
  }
  session.end_input();
  answers += run(session, target, token, counts);
  if (!session.is_finished() || answers != counts.requests + counts.too_long) {
    __builtin_trap();
  }
  return 0;
}
