#pragma once

#include "core/fix.hpp"
#include "core/geometry/pose2.hpp"
#include "firmware/config/sensor_config.hpp"
#include "firmware/output/nmea_sentence.hpp"

#include <Eigen/Core>
#include <GeographicLib/LocalCartesian.hpp>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::firmware {

/// A pose of the map frame W on the earth (WGS 84).
struct GeoPose {
  double latitude_deg = 0.0;   ///< [-90, 90]
  double longitude_deg = 0.0;  ///< [-180, 180]
  double height_m = 0.0;       ///< of the point of the map's plane above the ellipsoid
  double true_heading_deg =
      0.0;  ///< of the sensor's x' axis, clockwise from true north at the place, [0, 360)
  Eigen::Matrix2d R_EN_W =
      Eigen::Matrix2d::Identity();  ///< takes plane vectors in W to (east, north) at the place
};

/// Places the map on the earth: W is the plane that touches the datum's height surface at its latitude and
/// longitude, x towards the datum's true bearing, y 90 deg to its left, z up. Immutable, so any thread may
/// use it.
class GeoReference {
 public:
  explicit GeoReference(const Datum& datum);

  /// Where on the earth `T_W_L` is. East and north are those of the place, not of the datum: over a map of
  /// kilometres the meridians converge. Allocates nothing. A pose that is not finite gives values that are
  /// not finite.
  [[nodiscard]] GeoPose locate(const core::Pose2& T_W_L) const noexcept;

  [[nodiscard]] const Datum& datum() const noexcept { return datum_; }

 private:
  Datum datum_;
  GeographicLib::LocalCartesian plane_;  ///< east, north, up at the datum
  Eigen::Matrix2d R_plane_W_;            ///< map axes to the datum's (east, north)
  Eigen::Matrix3d R_earth_plane_;        ///< the datum's (east, north, up) to earth-centred axes
};

/// The 1 sigma error of a position, m, on true east and north, and its ellipse.
struct PositionError {
  double east_m = 0.0;
  double north_m = 0.0;
  double major_m = 0.0;
  double minor_m = 0.0;
  double major_bearing_deg = 0.0;  ///< clockwise from the second axis (north), [0, 180)
};

/// The ellipse of a covariance (m^2) of (east, north), or of any two axes.
[[nodiscard]] PositionError position_error(const Eigen::Matrix2d& covariance_m2) noexcept;

/// True when `covariance` of (x, y, heading) is finite and has no negative variance.
[[nodiscard]] bool usable_covariance(const Eigen::Matrix3d& covariance) noexcept;

/// Where the scans come from: a sensor head, or a recording or an emulator (GGA quality 8, RMC mode S).
enum class NmeaMode : std::uint8_t { Live, Simulated };

/// When an epoch is: its own time, which all of its sentences carry, and how old the scan is that it reports
/// of.
struct NmeaMoment {
  std::chrono::nanoseconds utc{0};                 ///< since 1970-01-01
  std::optional<std::chrono::nanoseconds> age{0};  ///< since the middle of the scan; empty before the first
};

/// What the sentences need beside the fix.
struct NmeaContext {
  std::array<char, 2> talker = {'G', 'P'};
  NmeaMode mode = NmeaMode::Live;
  NmeaQuality quality = NmeaQuality::Autonomous;  ///< of a live fix
  double landmark_sigma_m = 0.3;                  ///< 1 sigma of a landmark's place
  NmeaSentences sentences{};
  bool zda = false;                    ///< this epoch has a ZDA
  const GeoReference* geo = nullptr;   ///< null without a datum; outlives the call
  std::optional<NmeaMoment> moment{};  ///< empty: the middle of the scan, as when a list of scans is replayed
};

/// The context of the settings; `zda` is what they say, for the caller to thin out to once a second.
[[nodiscard]] NmeaContext nmea_context(const NmeaConfig& config, const GeoReference* geo,
                                       NmeaMode mode) noexcept;

/// Enough for any epoch: RMC, GGA, GBS, HDT, THS, GST, ZDA, PSLMA.
inline constexpr std::size_t kNmeaEpochBytesMax = 8 * kNmeaSentenceMax;

/// Writes the sentences of one epoch (DESIGN 4) and returns their bytes: of RMC, GGA, GBS, HDT, THS, GST, ZDA
/// and PSLMA, in this order, those that `context` asks for, all of the time of `context.moment` rounded to
/// 0.01 s, each at most 82 characters. Returns 0 and writes nothing when `out` is smaller than
/// kNmeaEpochBytesMax. Allocates nothing, knows no locale.
///
/// RMC to GST are those of a position when the status is Fix, the pose is finite, there is a datum, and the
/// home map is still the one that it was given for (Fix::is_home_replaced). Else RMC says V mode N, GGA
/// quality 0 (its HDOP empty: gpsd 3.22 keeps that of the epoch before for the first fix after it), all
/// fields of GBS and GST but the time are empty, THS says V and HDT is left out: a reader keeps the last
/// heading on an empty one. Speed and course are always empty.
///   GGA   satellites = matches, at most 99 (gpsd takes fewer than 3 as no fix); HDOP = sqrt(var x + var y) /
///         landmark_sigma_m within 0.01 .. 99.99, empty when the covariance is not usable; altitude = the
///         datum's height over geoid separation 0.0, that is, above the ellipsoid.
///   GBS   1 sigma to north and to east, m, of the covariance turned to true east and north.
///   GST   landmark_sigma_m as the RMS of the ranges; 1 sigma ellipse: major, minor, bearing of the major
///         axis; 1 sigma to north and to east. Altitude is not measured, so its sigma is empty here and in
///         GBS.
/// Latitude and longitude have 7 decimals of a minute (0.2 mm), fewer when the line would exceed 82
/// characters.
///
/// $PSLMA,POSE,time,status,mode,reason,x,y,heading,sigma,sigma_heading,xi,matches,seen,age,map,protection*hh
///    1  POSE           kind of sentence
///    2  time           hhmmss.ss UTC, that of the other sentences
///    3  status         A fix, U ambiguous (the pose is the better of two), V no fix
///    4  mode           A live, S replayed or emulated
///    5  reason         0 none, 1 too few landmarks, 2 no overlap, 3 symmetric, 4 deadline, 5 stale, 6
///                      device, 7 moved, 8 timing, 9 copy, 10 local map, 11 no scan
///    6  x              m in the map frame, within 1000 km of its origin
///    7  y              m
///    8  heading        deg, counter-clockwise from the map's x axis, [0, 360)
///    9  sigma          m, 1 sigma of the position along the longest axis of its ellipse, at most 9999
///   10  sigma_heading  deg, 1 sigma
///   11  xi             triangulations between the scan and the origin, at most 9999
///   12  matches        landmarks matched in the last scan, at most 999
///   13  seen           landmarks of the last scan, at most 999
///   14  age            s from the middle of the last scan to the time of the sentence, at most 99999
///   15  map            number of the map that the pose lies in: it grows when another map becomes the home
///   map 16  protection     m, the position's error exceeds it with at most the configured risk; rounded up,
///   at most
///                      9999
/// Fields 6 to 11, 15 and 16 are empty without a fix; 9 and 10 when the covariance is not usable; 14 before
/// the first scan; 16 when it is not known. A pose in a local map (reason 10) is no fix: LCM alone carries
/// it. Fields 6 to 9 have 3 decimals, 10, 14 and 16 have 2; fewer when the line would exceed 82 characters,
/// the age's first, those of x and y last; when not even that is enough 9, 10, 14 and 16 are empty.
[[nodiscard]] std::size_t format_nmea(const core::Fix& fix, const NmeaContext& context,
                                      std::span<char> out) noexcept;

}  // namespace slamsensor::firmware
