#include "firmware/control/control_request.hpp"

#include "firmware/config/setting.hpp"
#include "firmware/supervision/log.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

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

namespace {

using Parsed = tl::expected<void, ControlError>;

constexpr std::size_t kEditsMax = 2;  // a word farther off is not taken for a slip
constexpr std::size_t kNameMax = 64;
constexpr std::array<std::string_view, 2> kModeNames = {"continuous", "single"};

std::string quoted(std::string_view text) {
  return '\'' + std::string(text) + '\'';
}

tl::unexpected<ControlError> refuse(std::string message) {
  return refusal(ControlErrorCode::Value, std::move(message));
}

/// Takes one of `names` off `text`; a value of that number.
template <typename Value>
Parsed parse_choice(std::string_view& text, std::span<const std::string_view> names, Value& value) {
  const std::string_view word = take_word(text);
  const auto found = std::find(names.begin(), names.end(), word);
  if (found != names.end()) {
    value = static_cast<Value>(found - names.begin());
    return {};
  }
  std::string allowed;
  for (const std::string_view name : names) {
    allowed += (allowed.empty() ? "" : ", ") + std::string(name);
  }
  return refuse(quoted(word) + " is not allowed; allowed: " + allowed);
}

/// `word` as a number in the range of the setting `path`.
tl::expected<double, ControlError> parse_real(std::string_view word, std::string_view path) {
  const Setting& setting = settings()[*find_setting(path)];
  const auto& range = std::get<RealSetting>(setting.kind);
  double value = 0.0;
  const auto end = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end.ec != std::errc() || end.ptr != word.data() + word.size() || !std::isfinite(value) ||
      value < range.min || value > range.max) {
    return refuse(std::string(setting.key()) + ": " + quoted(word) +
                  " is not allowed; allowed: " + allowed_text(setting));
  }
  return value * range.scale;
}

/// What follows `words` in `line`, blank by blank; none when it does not begin with them.
std::optional<std::string_view> after_words(std::string_view line, std::string_view words) {
  while (!words.empty()) {
    if (take_word(words) != take_word(line)) {
      return std::nullopt;
    }
  }
  return line;
}

/// "now, pause, resume or mode": what may follow the first word `group`.
std::string second_words(std::string_view group) {
  std::vector<std::string_view> seconds;
  for (const ControlVerb& verb : control_verbs()) {
    std::string_view rest = verb.words;
    if (take_word(rest) == group && !rest.empty()) {
      seconds.push_back(rest);
    }
  }
  std::string text;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    text += i == 0 ? "" : i + 1 == seconds.size() ? " or " : ", ";
    text += seconds[i];
  }
  return text;
}

ControlError unknown(std::string_view line) {
  const std::string_view first = take_word(line);
  const std::string_view second = take_word(line);
  if (const std::string seconds = second_words(first); !seconds.empty()) {
    const std::string seen = second.empty() ? "nothing" : quoted(second);
    return {ControlErrorCode::Unknown,
            quoted(first) + " is followed by " + seconds + ", not by " + seen + "; help lists all requests"};
  }
  std::string message = "there is no request " + quoted(first);
  std::size_t least = std::min(kEditsMax, std::max<std::size_t>(first.size() / 3, 1)) + 1;
  std::string_view nearest;
  for (const ControlVerb& verb : control_verbs()) {
    std::string_view words = verb.words;
    const std::string_view word = take_word(words);
    const bool is_near = first.size() <= word.size() + kEditsMax && word.size() <= first.size() + kEditsMax;
    const std::size_t edits = is_near ? edit_distance(first, word) : least;
    if (edits < least) {
      least = edits;
      nearest = word;
    }
  }
  if (!nearest.empty()) {
    message += "; did you mean " + quoted(nearest) + '?';
  }
  return {ControlErrorCode::Unknown, message + "; help lists all requests"};
}

tl::unexpected<ControlError> misused(const ControlVerb& verb, std::string_view problem) {
  return refuse(std::string(problem) + "; say: " + verb.usage());
}

tl::expected<ControlRequest, ControlError> parse_rest(const ControlVerb& verb, std::string_view rest) {
  ControlRequest request;
  request.verb = &verb;
  if (rest.empty() && !verb.arguments.empty() && verb.arguments.front() != '[') {
    return misused(verb, "something is missing");
  }
  if (const auto parsed = verb.parse(rest, request); !parsed) {
    return tl::unexpected(parsed.error());
  }
  if (!rest.empty()) {
    return misused(verb, "nothing is known of " + quoted(rest));
  }
  if (verb.parse == parse_key_and_value && request.value.empty()) {
    return misused(verb, "the value is missing");
  }
  return request;
}

}  // namespace

bool map_name_allowed(std::string_view name) noexcept {
  return !name.empty() && name.size() <= kNameMax && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

Parsed parse_nothing(std::string_view&, ControlRequest&) {
  return {};
}

Parsed parse_json(std::string_view& text, ControlRequest& request) {
  if (text == "json") {
    request.form = ReplyForm::Json;
    text = {};
  }
  return {};
}

Parsed parse_words(std::string_view& text, ControlRequest& request) {
  while (!text.empty()) {
    request.name += (request.name.empty() ? "" : " ") + std::string(take_word(text));
  }
  return {};
}

Parsed parse_name(std::string_view& text, ControlRequest& request) {
  const std::string_view name = take_word(text);
  if (!map_name_allowed(name)) {
    return refuse(quoted(name) + " is no name: 1 to 64 of A-Z a-z 0-9 _ - are allowed");
  }
  request.name = name;
  return {};
}

Parsed parse_optional_name(std::string_view& text, ControlRequest& request) {
  return text.empty() ? Parsed() : parse_name(text, request);
}

Parsed parse_mode(std::string_view& text, ControlRequest& request) {
  return parse_choice(text, kModeNames, request.mode);
}

Parsed parse_level(std::string_view& text, ControlRequest& request) {
  return parse_choice(text, kLogLevelNames, request.level);
}

Parsed parse_datum(std::string_view& text, ControlRequest& request) {
  const std::array<std::pair<std::string_view, double*>, 4> fields = {
      {{"datum.latitude_deg", &request.datum.latitude_deg},
       {"datum.longitude_deg", &request.datum.longitude_deg},
       {"datum.height_m", &request.datum.height_m},
       {"datum.bearing_deg", &request.datum.bearing_deg}}};
  for (const auto& [path, value] : fields) {
    const auto read = parse_real(take_word(text), path);
    if (!read) {
      return tl::unexpected(read.error());
    }
    *value = *read;
  }
  return {};
}

Parsed parse_key(std::string_view& text, ControlRequest& request) {
  const std::string_view key = take_word(text);
  if (!find_setting(key)) {
    const std::string near = key.size() <= kNameMax ? suggest_key(key) : std::string();
    return refuse(quoted(key) + " is no setting; " + (near.empty() ? "" : "did you mean " + near + "? ") +
                  "config list names all");
  }
  request.name = key;
  return {};
}

Parsed parse_key_and_value(std::string_view& text, ControlRequest& request) {
  return parse_key(text, request).map([&] {
    request.value = text;
    text = {};
  });
}

tl::expected<ControlRequest, ControlError> parse_control_request(std::string_view line) {
  if (std::any_of(line.begin(), line.end(), [](char c) { return is_control(c) && c != '\t'; })) {
    return refusal(ControlErrorCode::Syntax, "a control character; requests are lines of text");
  }
  if (line.size() > kControlLineMax) {
    return refusal(ControlErrorCode::Syntax, "the line is longer than " + std::to_string(kControlLineMax) +
                                                 " bytes; send shorter ones");
  }
  for (const ControlVerb& verb : control_verbs()) {
    if (const auto rest = after_words(line, verb.words)) {
      return parse_rest(verb, *rest);
    }
  }
  return tl::unexpected(unknown(line));
}

std::string ControlVerb::usage() const {
  return std::string(words) + (arguments.empty() ? "" : " ") + std::string(arguments);
}

ControlResult control_help(std::string_view about) {
  std::vector<const ControlVerb*> listed;
  std::size_t width = 0;
  for (const ControlVerb& verb : control_verbs()) {
    if (verb.words.starts_with(about)) {
      listed.push_back(&verb);
      width = std::max(width, verb.usage().size());
    }
  }
  if (listed.empty()) {
    return refusal(ControlErrorCode::NotFound,
                   "there is no request '" + std::string(about) + "'; help lists all");
  }
  ControlReply reply;
  for (const ControlVerb* const verb : listed) {
    std::string line = verb->usage();
    line.resize(width + 2, ' ');
    reply.lines.push_back(line + std::string(verb->description));
  }
  return reply;
}

}  // namespace slamsensor::firmware
