#pragma once

#include "firmware/config/config.hpp"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware::rows {

/// The sentences that an epoch can have, in their order.
inline constexpr std::array<std::string_view, 8> kNmeaSentenceNames = {"RMC", "GGA", "GBS", "HDT",
                                                                       "THS", "GST", "ZDA", "PSLMA"};

/// Those of `config`, in their order.
[[nodiscard]] std::vector<std::string> chosen_sentences(const NmeaConfig& config);

/// Those of `names`, and no other, are in `config` afterwards; names that are no sentence do nothing.
void choose_sentences(const std::vector<std::string>& names, NmeaConfig& config);

}  // namespace slamsensor::firmware::rows
