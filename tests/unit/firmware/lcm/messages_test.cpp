#include "tests/unit/firmware/lcm/sample_reports.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

namespace slamsensor::firmware {
namespace {

using tests::sample_report;
using tests::sample_status;

template <typename T>
std::vector<std::uint8_t> bytes_of(const T& message) {
  std::vector<std::uint8_t> bytes(kLcmBytes<T>);
  EXPECT_EQ(encode_lcm(message, bytes), bytes.size());
  return bytes;
}

TEST(LcmPose, BringsTheWholeFix) {
  std::array<std::uint8_t, 1400> out{};
  const FixReport report = sample_report();
  const std::size_t size = encode_pose(report, out);
  const auto message = decode_lcm<PoseMessage>({out.data(), size});
  ASSERT_TRUE(message);
  const core::Fix fix = fix_of(*message);
  EXPECT_EQ(fix.time.start_utc, report.fix.time.start_utc);
  EXPECT_EQ(fix.time.middle_utc, report.fix.time.middle_utc);
  EXPECT_EQ(fix.time.end_utc, report.fix.time.end_utc);
  EXPECT_EQ(fix.time.end_monotonic, report.fix.time.end_monotonic);
  EXPECT_EQ(fix.scan, report.fix.scan);
  EXPECT_EQ(fix.status, report.fix.status);
  EXPECT_EQ(fix.reason, report.fix.reason);
  EXPECT_EQ(fix.search_end, report.fix.search_end);
  EXPECT_EQ(fix.pose_W.x_m, report.fix.pose_W.x_m);
  EXPECT_EQ(fix.pose_W.y_m, report.fix.pose_W.y_m);
  EXPECT_EQ(fix.pose_W.heading_rad, report.fix.pose_W.heading_rad);
  EXPECT_EQ(fix.covariance, report.fix.covariance);
  EXPECT_EQ(fix.error_xi, report.fix.error_xi);
  EXPECT_EQ(fix.matches, report.fix.matches);
  EXPECT_EQ(fix.landmarks_seen, report.fix.landmarks_seen);
  EXPECT_EQ(fix.landmarks_in_map, report.fix.landmarks_in_map);
  EXPECT_EQ(fix.expected_false_alarms, report.fix.expected_false_alarms);
  EXPECT_EQ(fix.weight_best, report.fix.weight_best);
  EXPECT_EQ(fix.weight_runner_up, report.fix.weight_runner_up);
  EXPECT_EQ(fix.jumps, report.fix.jumps);
  EXPECT_EQ(fix.map, 3U);
  EXPECT_EQ(fix.home, 3U);
  EXPECT_EQ(fix.protection_radius_m, 0.9);
  EXPECT_EQ(fix.covariance_near, report.fix.covariance_near);
  EXPECT_EQ(message->utime, 1'752'488'140'000'000);
  EXPECT_EQ(message->report_monotonic_ns, report.monotonic.count());
  EXPECT_EQ(message->uptime_ns, report.uptime.count());
  EXPECT_EQ(message->time_to_first_fix_ns, report.time_to_first_fix->count());
  EXPECT_EQ(static_cast<std::uint64_t>(message->initialization), report.initialization);
  EXPECT_EQ(static_cast<SourceMode>(message->source), report.source);
}

TEST(LcmPose, SaysThatThereWasNoFixYet) {
  std::array<std::uint8_t, 1400> out{};
  FixReport report = sample_report();
  report.time_to_first_fix.reset();
  const auto message = decode_lcm<PoseMessage>({out.data(), encode_pose(report, out)});
  ASSERT_TRUE(message);
  EXPECT_EQ(message->time_to_first_fix_ns, -1);
}

TEST(LcmPose, RefusesCodesThatMeanNothing) {
  for (std::int8_t PoseMessage::*code :
       {&PoseMessage::status, &PoseMessage::reason, &PoseMessage::search_end, &PoseMessage::source}) {
    for (const std::int8_t wrong : {std::int8_t{-1}, std::int8_t{99}}) {
      PoseMessage message;
      message.*code = wrong;
      EXPECT_FALSE(decode_lcm<PoseMessage>(bytes_of(message)));
    }
  }
  EXPECT_TRUE(decode_lcm<PoseMessage>(bytes_of(PoseMessage{})));
}

// The datagram's payload of libbot's type: fingerprint, time, then doubles, all most significant byte first.
TEST(LcmBotCorePose, IsWrittenForAFixAlone) {
  std::array<std::uint8_t, 144> out{};
  FixReport report = sample_report();
  report.fix.pose_W = {1.0, -2.0, M_PI / 2.0};
  report.fix.time.middle_utc = std::chrono::seconds(1'700'000'000);
  ASSERT_EQ(encode_bot_core_pose(report, out), 144U);
  const std::array<std::uint8_t, 32> begin = {0x2E, 0x16, 0xEF, 0xB0, 0x52, 0xB0, 0x10, 0x5E,  //
                                              0x00, 0x06, 0x0A, 0x24, 0x18, 0x1E, 0x40, 0x00,  //
                                              0x3F, 0xF0, 0,    0,    0,    0,    0,    0,     //
                                              0xC0, 0x00, 0,    0,    0,    0,    0,    0};
  EXPECT_TRUE(std::equal(begin.begin(), begin.end(), out.begin()));
  const auto message = decode_lcm<BotCorePose>(out);
  ASSERT_TRUE(message);
  EXPECT_NEAR(message->orientation[0], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(message->orientation[3], std::sqrt(0.5), 1e-15);

  for (const core::FixStatus none : {core::FixStatus::NoFix, core::FixStatus::Ambiguous}) {
    report.fix.status = none;
    EXPECT_EQ(encode_bot_core_pose(report, out), 0U);
  }
}

TEST(LcmStatus, BringsStateDevicesAndMap) {
  std::array<std::uint8_t, 1400> out{};
  const SensorStatus status = sample_status();
  const auto utc = std::chrono::nanoseconds(1'752'488'151'000'000'000);
  const auto message = decode_lcm<StatusMessage>({out.data(), encode_status(status, utc, out)});
  ASSERT_TRUE(message);
  EXPECT_EQ(message->utime, 1'752'488'151'000'000);
  EXPECT_EQ(static_cast<SensorState>(message->state), SensorState::Fixed);
  EXPECT_TRUE(message->held && message->realtime && message->map_frozen && message->map_unsaved);
  EXPECT_FALSE(message->recording);
  EXPECT_EQ(text_of(message->phase), "scanning");
  EXPECT_EQ(text_of(message->problem), status.head.problem.view());
  EXPECT_EQ(text_of(message->device_model[0]), "PTU-46-17.5");
  EXPECT_EQ(text_of(message->device_problem[0]), "");
  EXPECT_EQ(text_of(message->device_problem[1]), status.head.rangefinder.problem.view());
  EXPECT_EQ(message->device_state, (std::array<std::int8_t, 2>{2, 1}));
  EXPECT_EQ(message->device_recoveries[0], 2);
  EXPECT_EQ(message->device_last_recovery_ns[0], 1'234'000'000);
  EXPECT_EQ(message->line, 5);
  EXPECT_EQ(message->latency_s, 0.0051);
  EXPECT_EQ(message->readings, 3'060'000);
  EXPECT_EQ(message->process_max_ns, 9'000'000);
  EXPECT_EQ(message->map_revision, 44);
  EXPECT_EQ(message->landmarks, 345);
  EXPECT_EQ(message->local_maps, 2);
  EXPECT_EQ(message->local_landmarks, 31);
  EXPECT_EQ(text_of(message->map_name), "orchard");
  EXPECT_EQ(message->map_saved_ago_ns, 31'000'000'000);
}

TEST(LcmStatus, SaysThatTheMapWasNeverSaved) {
  std::array<std::uint8_t, 1400> out{};
  SensorStatus status = sample_status();
  status.map_saved_ago = hal::kNever;
  const auto message = decode_lcm<StatusMessage>({out.data(), encode_status(status, {}, out)});
  ASSERT_TRUE(message);
  EXPECT_EQ(message->map_saved_ago_ns, -1);
}

TEST(LcmCounters, AreAllThereInParts) {
  std::array<std::uint8_t, 1400> out{};
  const SensorStatus status = sample_status();
  std::vector<std::pair<std::string, std::int64_t>> got;
  for (std::size_t part = 0; part < kLcmCounterParts; ++part) {
    const std::size_t size = encode_counters(status, {}, LcmStation::Head, part, out);
    const auto message = decode_lcm<CountersMessage>({out.data(), size});
    ASSERT_TRUE(message) << part;
    EXPECT_EQ(message->parts, 2);
    for (std::size_t i = 0; i < static_cast<std::size_t>(message->count); ++i) {
      got.emplace_back(text_of(message->name[i]), message->value[i]);
    }
  }
  ASSERT_EQ(got.size(), 30U);
  EXPECT_EQ(got[29].first, "resynchronised");
  EXPECT_EQ(got[29].second, 0xFFFF'FFFF'FFFF);
  EXPECT_EQ(encode_counters(status, {}, LcmStation::Head, 2, out), 0U);
  EXPECT_EQ(encode_counters(status, {}, LcmStation::Slam, 1, out), 0U);
  EXPECT_EQ(encode_counters(status, {}, LcmStation::Slam, 0, out), kLcmBytes<CountersMessage>);
}

// For every number of landmarks around the edges of a chunk.
TEST(LcmScan, BringsTheLandmarksBitForBit) {
  std::array<std::uint8_t, 1400> out{};
  for (const std::size_t size : {0U, 1U, 39U, 40U, 41U, 80U, 81U}) {
    const std::vector<core::ScanLandmark> landmarks = tests::sample_landmarks(size);
    const LcmScanView scan = tests::view_of(landmarks);
    std::size_t next = 0;
    for (std::uint32_t chunk = 0; chunk < scan_chunks(scan); ++chunk) {
      const auto message = decode_lcm<ScanMessage>({out.data(), encode_scan_chunk(scan, chunk, out)});
      ASSERT_TRUE(message) << size << ", chunk " << chunk;
      EXPECT_EQ(message->landmarks, static_cast<std::int32_t>(size));
      EXPECT_EQ(message->scan, 4'294'967'290);
      EXPECT_EQ(scan_time_of(*message).middle_utc, scan.time.middle_utc);
      EXPECT_EQ(scan_time_of(*message).end_monotonic, scan.time.end_monotonic);
      for (std::size_t i = 0; i < static_cast<std::size_t>(message->count); ++i, ++next) {
        EXPECT_EQ(message->x_m[i], landmarks[next].position_L.x());
        EXPECT_EQ(message->y_m[i], landmarks[next].position_L.y());
        EXPECT_EQ(message->weight[i], landmarks[next].weight);
        EXPECT_EQ(message->diameter_m[i], landmarks[next].diameter_m);
      }
    }
    EXPECT_EQ(next, size);
    EXPECT_EQ(encode_scan_chunk(scan, scan_chunks(scan), out), 0U);
  }
}

TEST(LcmRivals, BringsThePlacesAndNothingWithoutAny) {
  std::array<std::uint8_t, 1400> out{};
  EXPECT_EQ(encode_rivals(tests::sample_rivals(0), out), 0U);
  for (const std::uint32_t size : {1U, 3U, 8U}) {
    const LcmRivalsView rivals = tests::sample_rivals(size);
    const auto message = decode_lcm<RivalsMessage>({out.data(), encode_rivals(rivals, out)});
    ASSERT_TRUE(message) << size;
    EXPECT_EQ(message->count, static_cast<std::int32_t>(size));
    EXPECT_EQ(message->scan, rivals.scan);
    const std::size_t last = size - 1;
    EXPECT_EQ(message->x_m[last], rivals.rivals[last].pose_W.x_m);
    EXPECT_EQ(message->y_m[last], rivals.rivals[last].pose_W.y_m);
    EXPECT_EQ(message->heading_rad[last], rivals.rivals[last].pose_W.heading_rad);
    EXPECT_EQ(message->matches[last], static_cast<std::int32_t>(20 - last));
  }
}

TEST(LcmRivals, MoreThanThereIsRoomForAreNoMessage) {
  RivalsMessage message;
  message.count = static_cast<std::int32_t>(kRivalsMax) + 1;
  std::array<std::uint8_t, kLcmBytes<RivalsMessage>> out{};
  ASSERT_NE(encode_lcm(message, out), 0U);
  EXPECT_FALSE(decode_lcm<RivalsMessage>(out));
}

TEST(LcmMap, BringsTheLandmarks) {
  std::array<std::uint8_t, 1400> out{};
  for (const std::uint32_t size : {0U, 1U, 25U, 26U, 1000U}) {
    const tests::SampleMap map(size);
    std::size_t next = 0;
    for (std::uint32_t chunk = 0; chunk < map_chunks(map.view()); ++chunk) {
      const auto message = decode_lcm<MapMessage>({out.data(), encode_map_chunk(map.view(), chunk, out)});
      ASSERT_TRUE(message) << size << ", chunk " << chunk;
      for (std::size_t i = 0; i < static_cast<std::size_t>(message->count); ++i, ++next) {
        EXPECT_EQ(message->id[i], map.landmarks[next].id);
        EXPECT_EQ(message->x_m[i], map.positions_W[next].x());
        EXPECT_EQ(message->sigma_m[i], static_cast<double>(map.landmarks[next].sigma_m));
        EXPECT_EQ(message->diameter_m[i], map.landmarks[next].size.diameter_m());
        EXPECT_EQ(message->xi[i], static_cast<std::int32_t>(map.landmarks[next].xi));
        EXPECT_EQ(message->sightings[i], static_cast<std::int32_t>(map.landmarks[next].sightings));
        EXPECT_EQ(message->last_scan[i], static_cast<std::int32_t>(map.landmarks[next].last_scan));
      }
    }
    EXPECT_EQ(next, size);
  }
}

TEST(LcmChunks, AreRefusedWhenTheirNumbersDisagree) {
  ScanMessage good;
  good.landmarks = 81;
  good.chunk = 2;
  good.chunks = 3;
  good.count = 1;
  EXPECT_TRUE(decode_lcm<ScanMessage>(bytes_of(good)));
  for (std::int32_t ScanMessage::*number :
       {&ScanMessage::landmarks, &ScanMessage::chunk, &ScanMessage::chunks, &ScanMessage::count}) {
    for (const std::int32_t wrong : {-1, INT32_MIN, INT32_MAX, 51}) {
      ScanMessage message = good;
      message.*number = wrong;
      EXPECT_FALSE(decode_lcm<ScanMessage>(bytes_of(message))) << wrong;
    }
  }
}

TEST(LcmCounters, AreRefusedBeyondTheirBounds) {
  for (std::int8_t CountersMessage::*number : {&CountersMessage::station, &CountersMessage::part,
                                               &CountersMessage::parts, &CountersMessage::count}) {
    for (const std::int8_t wrong : {std::int8_t{-1}, std::int8_t{25}, std::int8_t{127}}) {
      CountersMessage message;
      message.*number = wrong;
      EXPECT_FALSE(decode_lcm<CountersMessage>(bytes_of(message))) << int{wrong};
    }
  }
}

template <typename T>
class LcmMessageLaws : public testing::Test {};
using Messages = testing::Types<PoseMessage, BotCorePose, ScanMessage, RivalsMessage, MapMessage,
                                StatusMessage, CountersMessage>;
TYPED_TEST_SUITE(LcmMessageLaws, Messages);

TYPED_TEST(LcmMessageLaws, NeedTheirLengthAndTheirFingerprint) {
  std::vector<std::uint8_t> bytes = bytes_of(TypeParam{});
  ASSERT_TRUE(decode_lcm<TypeParam>(bytes));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode_lcm<TypeParam>({bytes.data(), size})) << size;
    EXPECT_EQ(encode_lcm(TypeParam{}, {bytes.data(), size}), 0U) << size;
  }
  for (std::size_t i = 0; i < 8; ++i) {
    bytes[i] ^= 1U;
    EXPECT_FALSE(decode_lcm<TypeParam>(bytes)) << i;
    bytes[i] ^= 1U;
  }
  bytes.push_back(0);
  EXPECT_FALSE(decode_lcm<TypeParam>(bytes));
}

// Whatever the bytes are, what is read is written again as it was.
TYPED_TEST(LcmMessageLaws, KeepEveryBit) {
  const unsigned seed = 20260711;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::uint8_t> bytes = bytes_of(TypeParam{});
    std::generate(bytes.begin() + 8, bytes.end(), [&] { return static_cast<std::uint8_t>(random() & 1U); });
    TypeParam message;
    lcm_detail::Reader reader(bytes.data() + 8);
    TypeParam::members(message, [&reader](std::string_view, auto& member) { reader.get(member); });
    EXPECT_EQ(bytes_of(message), bytes);
  }
}

}  // namespace
}  // namespace slamsensor::firmware
