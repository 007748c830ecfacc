#include "firmware/control/control_protocol.hpp"

#include "firmware/supervision/plain_text.hpp"

namespace slamsensor::firmware {
namespace {

/// `text` as one line.
void append_line(std::string& out, std::string_view text) {
  out += plain_text(text);
  out += '\n';
}

void append_data(std::string& out, std::string_view text) {
  for (bool more = true; more;) {
    const std::size_t end = text.find('\n');
    out += ' ';
    append_line(out, text.substr(0, end));
    more = end != text.npos;
    text.remove_prefix(more ? end + 1 : text.size());
  }
}

std::string error_text(const ControlError& error) {
  std::string out(kControlError);
  out += ' ';
  out += kControlErrorNames[static_cast<std::size_t>(error.code)];
  append_line(out, ": " + error.message);
  return out;
}

std::string reply_text(const ControlReply& reply) {
  std::string out;
  for (const std::string& line : reply.lines) {
    append_data(out, line);
  }
  out += kControlOk;
  append_line(out, reply.summary.empty() ? "" : ' ' + reply.summary);
  return out;
}

}  // namespace

std::string answer_text(const ControlResult& result) {
  std::string out = result ? reply_text(*result) : error_text(result.error());
  if (out.size() > kControlAnswerMax) {
    out = error_text({ControlErrorCode::Failed,
                      "the answer has " + std::to_string(out.size()) + " bytes, more than the " +
                          std::to_string(kControlAnswerMax) + " of this protocol; ask for less"});
  }
  return out;
}

}  // namespace slamsensor::firmware
