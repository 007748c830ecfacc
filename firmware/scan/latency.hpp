#pragma once

#include <cstdint>
#include <limits>

namespace slamsensor::firmware {

/// The latency between the two devices as it is known: what must be added to the stamp of a reading to get
/// the time at which the polls show the axis where the reading was made.
struct Latency {
  double latency_s = 0.0;
  double sigma_s = 0.0;
  std::uint32_t pairs = 0;  ///< that the last pass taken was made of; 0 while it is the configured value
  /// Of the polls that it was found with (Scanline::half_width_s). Polls with a greater one may be off by the
  /// difference: their stamps have moved within it by nobody knows how much. Infinite while not known.
  double half_width_s = std::numeric_limits<double>::infinity();
};

}  // namespace slamsensor::firmware
