#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;

// Names of the enumerators, in their order.
constexpr std::string_view kModes[] = {"continuous", "single", "one_shot"};
constexpr std::string_view kRoundings[] = {"nearest", "down", "toward_zero"};

constexpr auto kHead = &Config::scan_head;

constexpr Section kSections[] = {
    {"scan", "What is swept, and how. Defaults: experiments I and II of the paper, 51 scanlines of 5 s."},
    {"pan_fit", "How the pan angle of each reading is found from the positions that the unit tells."},
    {"latency", "How the constant latency between the two devices is found by the sensor itself."},
    {"motion",
     "How a scan is recognised that was not made from one place, because the carrier moved meanwhile."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"scan.pan_min_deg", "deg", "Right end of a scanline; pan is positive to the left.",
     degrees<kHead, &SensorHeadConfig::scan, &ScanConfig::pan_min_rad>(-180.0, 180.0)},
    {"scan.pan_max_deg", "deg", "Left end of a scanline.",
     degrees<kHead, &SensorHeadConfig::scan, &ScanConfig::pan_max_rad>(-180.0, 180.0)},
    {"scan.tilt_min_deg", "deg", "Lowest scanline; tilt is positive upwards.",
     degrees<kHead, &SensorHeadConfig::scan, &ScanConfig::tilt_min_rad>(-90.0, 90.0)},
    {"scan.tilt_max_deg", "deg", "Highest scanline.",
     degrees<kHead, &SensorHeadConfig::scan, &ScanConfig::tilt_max_rad>(-90.0, 90.0)},
    {"scan.tilt_step_deg", "deg", "From one scanline to the next.",
     degrees<kHead, &SensorHeadConfig::scan, &ScanConfig::tilt_step_rad>(0.001, 90.0)},
    {"scan.pan_speed_deg_s", "deg/s", "Speed of a sweep; at most the unit's.",
     degrees<kHead, &SensorHeadConfig::scan, &ScanConfig::pan_speed_radps>(0.1, 1000.0)},
    {"scan.tilt_speed_deg_s", "deg/s", "Speed from one scanline to the next; at most the unit's.",
     degrees<kHead, &SensorHeadConfig::scan, &ScanConfig::tilt_speed_radps>(0.1, 1000.0)},
    {"scan.mode", "", "One scan after the other; one for each request; or one at start and then for each request.",
     choice<kHead, &SensorHeadConfig::scan, &ScanConfig::mode>(kModes), Apply::Live},
    {"scan.calibration_lines", "", "Even: scanlines swept at start-up at one tilt, to find the latency between the devices.",
     integer<kHead, &SensorHeadConfig::scan, &ScanConfig::calibration_lines>(0, 100)},
    {"scan.calibration_tilt_deg", "deg", "Where they are swept.",
     degrees<kHead, &SensorHeadConfig::scan, &ScanConfig::calibration_tilt_rad>(-90.0, 90.0)},
    {"scan.settle_s", "s", "From the arrival of both axes to the sweep.",
     real<kHead, &SensorHeadConfig::scan, &ScanConfig::settle_s>(0.0, 10.0)},
    {"scan.late_data_s", "s", "How long data of an ended line may be under way.",
     real<kHead, &SensorHeadConfig::scan, &ScanConfig::late_data_s>(0.0, 10.0)},
    {"scan.move_margin_s", "s", "A move that takes so much longer than it should has stalled.",
     real<kHead, &SensorHeadConfig::scan, &ScanConfig::move_margin_s>(0.1, 60.0)},
    {"scan.retry_s", "s", "Rest between an aborted scan and the next.",
     real<kHead, &SensorHeadConfig::scan, &ScanConfig::retry_s>(0.0, 600.0)},
    {"scan.lines_rejected_max_share", "", "A scan with a larger share of rejected lines is aborted.",
     real<kHead, &SensorHeadConfig::scan, &ScanConfig::lines_rejected_max_share>(0.0, 1.0)},
    {"scan.pan_sigma_max_deg", "deg", "A line whose pan angles are known worse (1 sigma) is left out; a scan with too many gives no fix.",
     degrees<kHead, &SensorHeadConfig::scan, &ScanConfig::pan_sigma_max_rad>(0.01, 10.0)},
    {"scan.readings_per_line_max", "", "Room for the readings of a line; 56 bytes each.",
     integer<kHead, &SensorHeadConfig::scan, &ScanConfig::readings_per_line_max>(100, 2'000'000)},
    {"scan.polls_per_line_max", "", "Room for the positions of a line.",
     integer<kHead, &SensorHeadConfig::scan, &ScanConfig::polls_per_line_max>(10, 100'000)},

    {"pan_fit.polls_min", "", "Positions of the moving axis that a line needs.",
     integer<kHead, &SensorHeadConfig::pan_fit, &PanFitConfig::polls_min>(3, 1000)},
    {"pan_fit.poll_jitter_s", "s", "1 sigma of when a position is told, beside what is known of it.",
     real<kHead, &SensorHeadConfig::pan_fit, &PanFitConfig::poll_jitter_s>(0.0, 0.1)},
    {"pan_fit.speed_error_sigma", "", "1 sigma of the unit's clock, as a share.",
     real<kHead, &SensorHeadConfig::pan_fit, &PanFitConfig::speed_error_sigma>(0.0, 0.1)},
    {"pan_fit.speed_error_max", "", "A line whose speed is off by a larger share is rejected.",
     real<kHead, &SensorHeadConfig::pan_fit, &PanFitConfig::speed_error_max>(0.0, 0.5)},
    {"pan_fit.outliers_max_share", "", "A line with a larger share of positions off the fit is rejected.",
     real<kHead, &SensorHeadConfig::pan_fit, &PanFitConfig::outliers_max_share>(0.0, 0.5)},
    {"pan_fit.path_tolerance_deg", "deg", "So is a line of which a stretch is off the motion model by this, and more than by chance.",
     degrees<kHead, &SensorHeadConfig::pan_fit, &PanFitConfig::path_tolerance_rad>(0.0, 10.0)},
    {"pan_fit.rounding", "", "How the unit makes a whole position out of where its axis is.",
     choice<kHead, &SensorHeadConfig::pan_fit, &PanFitConfig::rounding>(kRoundings)},

    {"latency.self_calibration", "", "Whether the latency between the devices is found from opposite sweeps; else initial_s counts.",
     boolean<kHead, &SensorHeadConfig::latency, &LatencyConfig::self_calibration>()},
    {"latency.initial_s", "s", "Added to a reading's time until something better is known.",
     real<kHead, &SensorHeadConfig::latency, &LatencyConfig::initial_s>(-0.5, 0.5)},
    {"latency.initial_sigma_s", "s", "1 sigma of initial_s.",
     real<kHead, &SensorHeadConfig::latency, &LatencyConfig::initial_sigma_s>(1e-6, 0.5)},
    {"latency.search_s", "s", "The latency is looked for within this of initial_s.",
     real<kHead, &SensorHeadConfig::latency, &LatencyConfig::search_s>(0.001, 0.5)},
    {"latency.pair_sigma_max_s", "s", "A pair of lines that tells it less well is left out.",
     real<kHead, &SensorHeadConfig::latency, &LatencyConfig::pair_sigma_max_s>(1e-5, 0.1)},
    {"latency.range_max_m", "m", "For this, what is farther counts as no return.",
     real<kHead, &SensorHeadConfig::latency, &LatencyConfig::range_max_m>(1.0, 10'000.0)},
    {"latency.pairs_min", "", "Pairs of lines that an estimate is made of.",
     integer<kHead, &SensorHeadConfig::latency, &LatencyConfig::pairs_min>(1, 1000)},
    {"latency.departure_sigmas", "", "A later estimate that is farther off than this is a departure ...",
     real<kHead, &SensorHeadConfig::latency, &LatencyConfig::departure_sigmas>(1.0, 100.0)},
    {"latency.departure_min_s", "s", "... if it is off by at least this.",
     real<kHead, &SensorHeadConfig::latency, &LatencyConfig::departure_min_s>(0.0, 0.1)},
    {"latency.confirmations", "", "Departures in a row that agree, until they are believed.",
     integer<kHead, &SensorHeadConfig::latency, &LatencyConfig::confirmations>(1, 100)},
    {"latency.drift_sigma_s", "s", "1 sigma by which the latency may change in a scan.",
     real<kHead, &SensorHeadConfig::latency, &LatencyConfig::drift_sigma_s>(0.0, 0.01)},

    {"motion.enabled", "", "Whether a scan during which the carrier moved is recognised and rejected.",
     boolean<kHead, &SensorHeadConfig::motion, &MotionConfig::enabled>()},
    {"motion.distance_min_m", "m", "A shorter move ...",
     real<kHead, &SensorHeadConfig::motion, &MotionConfig::distance_min_m>(0.01, 10.0)},
    {"motion.angle_min_deg", "deg", "... and a lesser turn are let pass.",
     degrees<kHead, &SensorHeadConfig::motion, &MotionConfig::angle_min_rad>(0.06, 57.0)},
    {"motion.sigmas", "", "Standard deviations that a move must be sure by.",
     real<kHead, &SensorHeadConfig::motion, &MotionConfig::sigmas>(3.0, 100.0)},
    {"motion.range_max_m", "m", "What is farther is not looked at.",
     real<kHead, &SensorHeadConfig::motion, &MotionConfig::range_max_m>(5.0, 1000.0)},
    {"motion.lost_share_min", "", "Of what stood for some lines, so much has to be gone.",
     real<kHead, &SensorHeadConfig::motion, &MotionConfig::lost_share_min>(0.1, 1.0)},
    {"motion.things_min", "", "Things that a judgement needs at least.",
     integer<kHead, &SensorHeadConfig::motion, &MotionConfig::things_min>(3, 100)},
    {"motion.coherent_share_min", "", "Of what a line sees, so much the lines before must have seen.",
     real<kHead, &SensorHeadConfig::motion, &MotionConfig::coherent_share_min>(0.0, 1.0)},
};
// clang-format on

}  // namespace

SettingRows scan_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
