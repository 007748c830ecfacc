#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/config/setting.hpp"
#include "hal/rangefinder/point_laser.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware::rows {

extern const TextRule kDevicePath;          ///< of a terminal
extern const TextRule kOptionalDevicePath;  ///< or empty
extern const TextRule kFolder;
extern const TextRule kSocketPath;
extern const TextRule kMapName;
extern const TextRule kInterface;  ///< of the network
extern const TextRule kIioDevice;
extern const TextRule kIpAddress;
extern const TextRule kLcmUrl;  ///< or empty
extern const TextRule kLcmPrefix;
extern const TextRule kLcmChannel;  ///< or empty
extern const TextRule kGpioChip;    ///< or empty
extern const TextRule kTerminator;
extern const TextRule kRecordPrefix;
extern const TextRule kSeparator;
extern const TextRule kCommand;
extern const TextRule kPointCode;  ///< "65535=none"
extern const TextRule kPointText;  ///< "DE02=none"
extern const TextRule kSentence;   ///< of NMEA

// What a point laser sends instead of a distance, as the configuration writes it: "65535=none",
// "DE02=fault". Behind the equals sign: none, weak, saturated or fault.
[[nodiscard]] std::optional<hal::PointCode> parse_point_code(std::string_view item);
/// The text has 1 to 32 characters of ASCII; it may hold an equals sign itself.
[[nodiscard]] std::optional<hal::PointText> parse_point_text(std::string_view item);

/// Those items that can be parsed.
[[nodiscard]] std::vector<hal::PointCode> point_codes(const std::vector<std::string>& items);
[[nodiscard]] std::vector<hal::PointText> point_texts(const std::vector<std::string>& items);

[[nodiscard]] std::vector<std::string> texts_of(const std::vector<hal::PointCode>& codes);
[[nodiscard]] std::vector<std::string> texts_of(const std::vector<hal::PointText>& texts);

/// The sentences that an epoch can have, in their order.
inline constexpr std::array<std::string_view, 8> kNmeaSentenceNames = {"RMC", "GGA", "GBS", "HDT",
                                                                       "THS", "GST", "ZDA", "PSLMA"};

/// Those of `config`, in their order.
[[nodiscard]] std::vector<std::string> chosen_sentences(const NmeaConfig& config);

/// Those of `names`, and no other, are in `config` afterwards; names that are no sentence do nothing.
void choose_sentences(const std::vector<std::string>& names, NmeaConfig& config);

}  // namespace slamsensor::firmware::rows
