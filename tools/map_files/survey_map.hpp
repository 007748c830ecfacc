#pragma once

#include "firmware/store/map_file.hpp"
#include "tools/map_files/survey_points.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::tools {

/// What the user says of the map to be made.
struct SurveyMapWishes {
  std::optional<firmware::Datum> datum;
  core::Point2 origin_m = core::Point2::Zero();  ///< subtracted from local metres
  bool frozen = true;
};

struct SurveyMap {
  firmware::MapFile map;            ///< without a name
  std::size_t at_one_place = 0;     ///< points left out: within a centimetre of one before them
  bool are_ids_kept = false;        ///< the landmarks have the ids of the survey
  bool is_datum_of_points = false;  ///< nobody named a datum: it is the middle of the points
};

/// A map of the points as landmarks without error (xi 0) that were seen once, and no path. Latitudes and
/// longitudes become metres about the datum: the one wished, else the file's, else the points' middle with x
/// towards east. An error names the file, the line and what to do.
[[nodiscard]] tl::expected<SurveyMap, InputError> map_of_survey(const Survey& survey, std::string_view name,
                                                                const SurveyMapWishes& wishes);

}  // namespace slamsensor::tools
