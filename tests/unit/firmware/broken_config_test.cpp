#include "firmware/config/load_config.hpp"

#include <gmock/gmock.h>

namespace slamsensor::firmware {
namespace {

struct Broken {
  const char* text;
  const char* message;  ///< stands in the first error
};

void PrintTo(const Broken& broken, std::ostream* out) {
  *out << broken.text;
}

class BrokenConfig : public testing::TestWithParam<Broken> {};

TEST_P(BrokenConfig, IsRefusedWithPlaceAndReason) {
  const auto loaded = load_config_text(GetParam().text, "f.toml");
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().front().text(), testing::HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Syntax, BrokenConfig,
    testing::Values(Broken{"[detection\n", "f.toml:1:"}, Broken{"[detection]\nrange_max_m = \n", "f.toml:2:"},
                    Broken{"[detection]\nrange_max_m 3\n", "not TOML"}, Broken{"= 3", "f.toml:1:1: not TOML"},
                    Broken{"[nmea]\ntalker = \"GP\n", "f.toml:2:"},
                    Broken{"[nmea]\ntalker = GP\n", "not TOML"},
                    Broken{"[detection]\nlandmarks_max = 3\nlandmarks_max = 4\n", "f.toml:3:"},
                    Broken{"[detection]\n[detection]\n", "f.toml:2:"},
                    Broken{"[detection]\nlandmarks_max = 99999999999999999999\n", "f.toml:2:"},
                    Broken{"\xff\xfe[detection]", "not TOML"},
                    Broken{"[detection]\nlandmarks_max = 010\n", "f.toml:2:"}));

INSTANTIATE_TEST_SUITE_P(
    Unknown, BrokenConfig,
    testing::Values(
        Broken{"[detector]\n", "detector: unknown section; did you mean detection?"},
        Broken{"[quux_and_more]\n", "unknown section; 'slamsensor check-config' lists"},
        Broken{"speed = 3\n", "f.toml:1:1: speed: unknown key"},
        Broken{"tolerance_m = 3\n", "did you mean association.tolerance_m?"},
        Broken{"[detection]\nlandmark_max = 3\n", "did you mean detection.landmarks_max?"},
        Broken{"[detection]\ntilt_min_rad = 0.1\n", "did you mean detection.tilt_min_deg?"},
        Broken{"[detection]\ntilt_min_deg.value = 1\n", "value (a table) is not a number"},
        Broken{"[detection.sub]\nx = 1\n", "detection.sub: unknown key"},
        Broken{"[mapping]\n\"a\\nb\" = 1\n", "mapping.a?b: unknown key"},
        Broken{"detection = 5\n", "value 5 stands where a section is expected; write [detection]"},
        Broken{"[[detection]]\nrange_max_m = 5\n", "value (an array) stands where a section is expected"}));

INSTANTIATE_TEST_SUITE_P(
    Type, BrokenConfig,
    testing::Values(
        Broken{"[detection]\nrange_max_m = \"300\"\n",
               "f.toml:2:15: detection.range_max_m: value \"300\" is not a number; allowed: 1.0 .. 2000.0 m; "
               "write one "
               "of these, or delete the line for the default 300.0"},
        Broken{"[detection]\nrange_max_m = true\n", "value true is not a number"},
        Broken{"[detection]\nrange_max_m = [1, 2]\n", "value (an array) is not a number"},
        Broken{"[detection]\nrange_max_m = 2001-01-01\n", "value (a date or time) is not a number"},
        Broken{"[detection]\nlandmarks_max = 30.0\n", "value 30.0 is not a whole number; allowed: 3 .. 128"},
        Broken{"[point_cloud]\nabsent_is_no_return = 1\n", "value 1 is neither true nor false"},
        Broken{"[nmea]\ntalker = 5\n", "value 5 is not a text in quotes"},
        Broken{"[mapping]\nupdate = \"median\"\n",
               "value \"median\" is not one of the names; allowed: \"paper\" or \"mean\""},
        Broken{"[mapping]\nupdate = \"Paper\"\n", "is not one of the names"}));

INSTANTIATE_TEST_SUITE_P(
    Range, BrokenConfig,
    testing::Values(
        Broken{"[detection]\nrange_max_m = inf\n", "value inf is not a finite number"},
        Broken{"[detection]\nrange_max_m = -inf\n", "value -inf is not a finite number"},
        Broken{"[detection]\nrange_max_m = 5e3\n", "value 5000.0 is out of range; allowed: 1.0 .. 2000.0 m"},
        Broken{"[detection]\ntilt_min_deg = -90.1\n",
               "value -90.1 is out of range; allowed: -90.0 .. 90.0 deg"},
        Broken{"[detection]\nlandmarks_max = -1\n", "value -1 is out of range"},
        Broken{"[detection]\nlandmarks_max = 4294967300\n", "value 4294967300 is out of range"},
        Broken{"[association]\norder_share = 0\n", "value 0 is out of range; allowed: 0.0001 .. 1.0;"},
        Broken{"[mapping]\nhypotheses_max = 9\n", "allowed: 1 .. 8"},
        Broken{"[capacities]\npath_poses = 0\n", "capacities.path_poses: value 0 is out of range"}));

INSTANTIATE_TEST_SUITE_P(
    Rules, BrokenConfig,
    testing::Values(
        Broken{"[detection]\ntilt_min_deg = 3\ntilt_max_deg = 2\n",
               "f.toml:2:16: detection.tilt_min_deg: value 3.0 is above detection.tilt_max_deg = 2.0 "
               "(f.toml:3)"},
        Broken{"[detection]\nrange_min_m = 50\nrange_max_m = 50\n",
               "value 50.0 is not below detection.range_max_m"},
        Broken{"[detection]\nrange_max_m = 2\nrange_step_m = 3\n",
               "value 3.0 is above detection.range_max_m = 2.0"},
        Broken{"[detection]\nrange_max_m = 2000\nrange_step_m = 0.01\nbearing_step_deg = 0.01\n",
               "value 0.01 makes a grid of 7200000000.0 cells, more than the allowed 20000000.0"},
        Broken{"[capacities]\nscan_landmarks = 20\n",
               "capacities.scan_landmarks: value 20 is too small for detection.landmarks_max = 30 (default)"},
        Broken{"[capacities]\noccupied_cells = 700\n",
               "capacities.occupied_cells: value 700 is too small for the cells of one scanline all the way "
               "round, "
               "detection.bearing_step_deg = 0.514 (default)"},
        Broken{"[capacities]\nmap_landmarks = 20\n", "capacities.map_landmarks: value 20 is too small"},
        Broken{"[capacities]\nmap_landmarks = 20000\n",
               "f.toml:2:17: capacities.map_edges: value 120000 is too small: 198000 edges are needed with "
               "capacities.map_landmarks = 20000 (f.toml:2), association.depth = 2 (default)"},
        Broken{"[association]\nlandmarks_min = 31\n", "value 31 leaves no scan to be searched"},
        Broken{"[datum]\nlatitude_deg = 1\nlongitude_deg = 2\nheight_m = 3\n",
               "f.toml:1:1: datum.bearing_deg: is missing; the keys of [datum] are given together"},
        Broken{"[datum]\n", "datum.latitude_deg: is missing"},
        Broken{"[datum]\nlatitude_deg = 91\nlongitude_deg = 2\nheight_m = 3\nbearing_deg = 0\n",
               "value 91 is out of range; allowed: -90.0 .. 90.0 deg; write one of these"}));

}  // namespace
}  // namespace slamsensor::firmware
