#include "tools/view/daemon_facts.hpp"

#include "tools/control/ctl.hpp"
#include "tools/input/text.hpp"

#include <nlohmann/json.hpp>

#include <chrono>

namespace slamsensor::tools {
namespace {

using Json = nlohmann::json;

/// The number behind "KEY: " in the lines of an answer.
std::optional<double> number_in(const ControlAnswer& answer, const std::string& key) {
  for (const std::string& line : answer.lines) {
    if (line.starts_with(key + ": ")) {
      return parse_number(std::string_view(line).substr(key.size() + 2));
    }
  }
  return std::nullopt;
}

std::optional<firmware::Datum> datum_in(const ControlAnswer& answer) {
  const auto latitude = number_in(answer, "latitude_deg");
  const auto longitude = number_in(answer, "longitude_deg");
  const auto height = number_in(answer, "height_m");
  const auto bearing = number_in(answer, "bearing_deg");
  if (!latitude || !longitude || !height || !bearing) {
    return std::nullopt;
  }
  firmware::Datum datum;
  datum.latitude_deg = *latitude;
  datum.longitude_deg = *longitude;
  datum.height_m = *height;
  datum.bearing_deg = *bearing;
  return datum;
}

}  // namespace

std::optional<DaemonFacts> ask_facts(const std::string& socket) {
  auto client = ControlClient::connect(socket);
  if (!client) {
    return std::nullopt;
  }
  const auto ask = [&client](std::string_view request) -> std::optional<ControlAnswer> {
    auto answer = client->ask(request, std::chrono::seconds(2));
    return answer && answer->is_ok ? std::optional(std::move(*answer)) : std::nullopt;
  };
  const auto status = ask("status json");
  const auto datum = status ? ask("datum show") : std::nullopt;
  const auto stale = datum ? ask("config get fix.stale_s") : std::nullopt;
  const auto stale_s = stale ? number_in(*stale, "value") : std::nullopt;
  const Json json =
      status && !status->lines.empty() ? Json::parse(status->lines.front(), nullptr, false) : Json();
  if (!stale_s || !json.is_object() || !json.contains("initialization") ||
      !json["initialization"].is_number_integer()) {
    return std::nullopt;
  }
  DaemonFacts facts;
  facts.initialization = json["initialization"].get<std::int64_t>();
  const Json fix = json.value("fix", Json::object());
  const bool is_datum_void = fix.is_object() && fix.contains("home_replaced") && fix["home_replaced"] == true;
  facts.datum = is_datum_void ? std::nullopt : datum_in(*datum);
  facts.stale_s = *stale_s;
  return facts;
}

void set_facts(const std::optional<DaemonFacts>& facts, const DaemonFacts& configured, SensorStory& story) {
  const bool is_sender =
      facts && (!story.initialization() || *story.initialization() == facts->initialization);
  const DaemonFacts& used = is_sender ? *facts : configured;
  story.set_datum(used.datum, is_sender ? DatumSource::Sensor : DatumSource::Configuration);
  story.set_stale_s(used.stale_s);
}

}  // namespace slamsensor::tools
