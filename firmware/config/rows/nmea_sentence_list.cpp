#include "firmware/config/rows/nmea_sentence_list.hpp"

#include <algorithm>

namespace slamsensor::firmware::rows {
namespace {

/// The switch of each name.
std::array<bool*, kNmeaSentenceNames.size()> switches(NmeaConfig& config) {
  NmeaSentences& chosen = config.sentences;
  return {&chosen.rmc, &chosen.gga, &chosen.gbs, &chosen.hdt,
          &chosen.ths, &chosen.gst, &config.zda, &chosen.pslma};
}

}  // namespace

std::vector<std::string> chosen_sentences(const NmeaConfig& config) {
  NmeaConfig copy = config;
  const auto is_on = switches(copy);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < is_on.size(); ++i) {
    if (*is_on[i]) {
      names.emplace_back(kNmeaSentenceNames[i]);
    }
  }
  return names;
}

void choose_sentences(const std::vector<std::string>& names, NmeaConfig& config) {
  const auto is_on = switches(config);
  for (std::size_t i = 0; i < is_on.size(); ++i) {
    *is_on[i] = std::find(names.begin(), names.end(), kNmeaSentenceNames[i]) != names.end();
  }
}

}  // namespace slamsensor::firmware::rows
