#pragma once

#include "firmware/config/setting.hpp"

/// What the texts of the configuration must be like.
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
extern const TextRule kProductName;
extern const TextRule kTerminator;
extern const TextRule kRecordPrefix;
extern const TextRule kSeparator;
extern const TextRule kCommand;
extern const TextRule kPointCode;  ///< "65535=none"
extern const TextRule kPointText;  ///< "DE02=none"
extern const TextRule kSentence;   ///< of NMEA

}  // namespace slamsensor::firmware::rows
