#pragma once

#include "core/config.hpp"
#include "core/decision/scan_view.hpp"
#include "firmware/config/daemon_config.hpp"
#include "firmware/device/head_config.hpp"
#include "firmware/scan/scan_config.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace slamsensor::firmware {

/// How a point cloud becomes scanlines (tools/input/pcd). A cloud with a `ring` field has a scanline per
/// ring.
struct PointCloudConfig {
  double tilt_step_rad =
      0.5 * core::kDegree;          ///< without rings, points are grouped into scanlines of this height
  bool absent_is_no_return = true;  ///< a column without a point was looked at and nothing came back
  double roll_rad = 0.0;            ///< attitude of the sensor, taken out of every point before anything else
  double pitch_rad = 0.0;
};

/// What makes a landmark of a list heavy; the heaviest `detection.landmarks_max` are used.
enum class LandmarkOrder : std::uint8_t { Weight, Diameter, Nearest };

/// How a list of landmarks (DESIGN 6) becomes a scan.
struct LandmarkListConfig {
  LandmarkOrder order = LandmarkOrder::Weight;
  double weight_min = 0.0;  ///< lighter rows are left out
  double diameter_min_m = 0.0;
  double field_of_view_rad =
      0.0;               ///< of the sensor that saw them, centred on its forward axis; 0 = not known
  double range_m = 0.0;  ///< up to which it sees landmarks; 0 = not known

  /// What a scan of such a list has seen beside its landmarks.
  [[nodiscard]] core::ScanView view() const noexcept { return {{}, field_of_view_rad, range_m, false}; }
};

/// Ties the map frame to the earth (DESIGN 4). Its four keys are given together or not at all.
struct Datum {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;      ///< ellipsoidal
  double bearing_deg = 90.0;  ///< true bearing of the map's x axis, clockwise from north
};

/// What a live fix calls itself in GGA and RMC: quality 1 mode A, 4 R, 5 F.
enum class NmeaQuality : std::uint8_t { Autonomous, RtkFixed, RtkFloat };

/// The sentences of an epoch; their order is fixed.
struct NmeaSentences {
  bool rmc = true;
  bool gga = true;
  bool gbs = true;
  bool hdt = true;
  bool ths = false;  ///< heading with a mode letter, V without a fix, where HDT is left out
  bool gst = true;
  bool pslma = true;
};

struct NmeaConfig {
  std::string talker = "GP";
  NmeaQuality quality = NmeaQuality::Autonomous;
  NmeaSentences sentences{};
  bool zda = false;               ///< date and time as a sentence of its own, once a second
  bool prompt = true;             ///< the answer of a scan also at once, between two regular epochs
  double landmark_sigma_m = 0.3;  ///< 1 sigma of a landmark's place: unit of HDOP and the RMS of GST
};

/// Every setting of the product.
struct Config {
  core::Config core;
  PointCloudConfig point_cloud;
  LandmarkListConfig landmark_list;
  NmeaConfig nmea;
  std::optional<Datum> datum;
  HeadConfig head;             ///< the devices
  SensorHeadConfig scan_head;  ///< what they do
  DaemonConfig daemon;
};

}  // namespace slamsensor::firmware
