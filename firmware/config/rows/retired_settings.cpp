#include "firmware/config/setting.hpp"

#include <algorithm>
#include <iterator>

namespace slamsensor::firmware {
namespace {

/// In alphabetical order. A key that is removed from the tables of settings is added here, and so is a value
/// that is removed from the names of a key, so that the configuration of a user who upgrades still starts his
/// sensor.
constexpr std::string_view kRetired[] = {
    "acceptance.ambiguity_risk",
    "acceptance.elsewhere_deg",
    "acceptance.elsewhere_m",
    "acceptance.false_alarm_risk",
    "acceptance.rule = \"computed\"",
    "association.index_neighbours",
    "association.landmarks_min",
    "benewake.clock_lump_s",
    "benewake.clock_stop_s",
    "benewake.clock_timing",
    "benewake.clock_tolerance_ppm",
    "benewake.over_range_cm",
    "benewake.reply_patience_s",
    "canopen.acknowledge_timeout_s",
    "canopen.boot_wait_s",
    "canopen.heartbeat_s",
    "canopen.heartbeat_timeout_s",
    "canopen.position_timeout_s",
    "canopen.rest_poll_hz",
    "canopen.retry_first_s",
    "canopen.retry_longest_s",
    "canopen.sdo_attempts",
    "canopen.sdo_timeout_s",
    "canopen.state_timeout_s",
    "canopen.sync_half_width_s",
    "capacities.scan_readings",
    "gpio.interlock_debounce_s",
    "gpio.trigger_debounce_s",
    "inclination.can_poll_hz",
    "inclination.iio_gravity_share_max",
    "inclination.iio_mean_s",
    "inclination.iio_poll_hz",
    "inclination.max_age_s",
    "inclination.moved_deg",
    "latency.confirmations",
    "latency.departure_min_s",
    "latency.departure_sigmas",
    "latency.drift_sigma_s",
    "latency.initial_sigma_s",
    "latency.pair_sigma_max_s",
    "latency.pairs_min",
    "latency.search_s",
    "lcm.map_period_s",
    "lcm.status_hz",
    "lwnx.clock_lump_s",
    "lwnx.clock_stop_s",
    "lwnx.clock_timing",
    "lwnx.clock_tolerance_ppm",
    "lwnx.lost_signal_counter",
    "lwnx.rate_width",
    "lwnx.reading_unit_m",
    "lwnx.reply_patience_s",
    "mapping.prune_chances_min",
    "motion.angle_min_deg",
    "motion.coherent_share_min",
    "motion.distance_min_m",
    "motion.lost_share_min",
    "motion.range_max_m",
    "motion.sigmas",
    "motion.things_min",
    "nmea.tcp_clients_max",
    "nmea.zda",
    "pan_fit.outliers_max_share",
    "pan_fit.path_tolerance_deg",
    "pan_fit.poll_jitter_s",
    "pan_fit.polls_min",
    "pan_fit.rounding",
    "pan_fit.speed_error_max",
    "pan_fit.speed_error_sigma",
    "pan_tilt_port.data_bits",
    "pan_tilt_port.latency",
    "pan_tilt_port.parity",
    "pan_tilt_port.reopen_first_s",
    "pan_tilt_port.reopen_longest_s",
    "pan_tilt_port.stop_bits",
    "pan_tilt_rs485.receive_own",
    "point_laser.byte_order",
    "point_laser.clock_lump_s",
    "point_laser.clock_stop_s",
    "point_laser.clock_tolerance_ppm",
    "point_laser.layout",
    "point_laser.prefix_is",
    "point_laser.product",
    "point_laser.record = \"pair\"",
    "point_laser.resolution_m",
    "ptu.baud_wait_s",
    "ptu.delimiter",
    "ptu.drain_s",
    "ptu.half_width_max_s",
    "ptu.mode_timeout_s",
    "ptu.move_latency_max_s",
    "ptu.reset_timeout_s",
    "ptu.rest_poll_hz",
    "ptu.retry_wait_s",
    "ptu.stamp_slack_s",
    "ptu.wake_wait_s",
    "rangefinder_port.latency",
    "rangefinder_port.reopen_first_s",
    "rangefinder_port.reopen_longest_s",
    "rangefinder_rs485.receive_own",
    "realtime.scan_deadline_s",
    "realtime.scan_period_s",
    "realtime.scan_priority",
    "realtime.scanlines_queued",
    "realtime.slam_priority",
    "scan.calibration_tilt_deg",
    "scan.lines_rejected_max_share",
    "scan.move_margin_s",
    "scan.pan_sigma_max_deg",
    "scan.polls_per_line_max",
    "scan.retry_s",
};
static_assert(std::is_sorted(std::begin(kRetired), std::end(kRetired)));

}  // namespace

std::span<const std::string_view> retired_settings() {
  return kRetired;
}

bool is_retired(std::string_view setting) {
  return std::binary_search(std::begin(kRetired), std::end(kRetired), setting);
}

bool is_retired_section(std::string_view name) {
  return std::any_of(std::begin(kRetired), std::end(kRetired),
                     [&](std::string_view key) { return key.substr(0, key.find('.')) == name; });
}

}  // namespace slamsensor::firmware
