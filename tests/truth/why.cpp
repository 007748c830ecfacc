// Why a scan is no fix, or a wrong one: replays scans whose true poses are known, and writes for each scan
// what the decision knew of the right place and of its strongest rival.
//
//     truth_why CONFIG.toml|- TRUTH.tum INPUT... > why.csv
//
// Columns: `known`: landmarks of the scan that stand at a landmark of the home map from the true pose, before
// the scan changes the map. `r_`: the best candidate at the right place of the home map, `w_`: the best at
// another place of any map: matches, decades of the Bayes factor, decades of independent groups, decades
// against. `says`: what the decision says of the home map alone. `structure`: how far this world repeats
// itself, decades. tests/truth/why sums them up.

#include "core/decision/decision.hpp"
#include "core/fix.hpp"
#include "firmware/config/load_config.hpp"
#include "firmware/pipeline.hpp"
#include "tools/input/scan_source.hpp"
#include "tools/input/text_files.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

namespace slamsensor::tools {
namespace {

// A place: a map that drifts or bends moves a right pose by less than this.
constexpr double kPlace_m = 3.0;
constexpr double kPlace_rad = 0.1;

using Truth = std::map<std::int64_t, core::Pose2>;

bool is_at(const core::Pose2& pose, const core::Pose2& truth) {
  return (pose.translation() - truth.translation()).norm() <= kPlace_m &&
         std::abs(core::wrap_angle(pose.heading_rad - truth.heading_rad)) <= kPlace_rad;
}

/// True poses in the frames of the maps, each of which is that of the scan which began the map.
class Frames {
 public:
  explicit Frames(const Truth& truth) : truth_(truth) {}

  void note(const core::Atlas& atlas, std::int64_t scan) {
    const auto pose = truth_.find(scan);
    for (const core::MapEntry& map : atlas.maps()) {
      if (map.number != 0 && pose != truth_.end()) {
        origins_.try_emplace(map.number, pose->second);
      }
    }
  }
  [[nodiscard]] std::optional<core::Pose2> truth_in(std::uint32_t map, std::int64_t scan) const {
    const auto origin = origins_.find(map);
    const auto pose = truth_.find(scan);
    if (origin == origins_.end() || pose == truth_.end()) {
      return std::nullopt;
    }
    return origin->second.inverse() * pose->second;
  }

 private:
  const Truth& truth_;
  std::map<std::uint32_t, core::Pose2> origins_;
};

std::size_t count_known(const core::Atlas& atlas, const std::vector<core::ScanLandmark>& landmarks,
                        const core::Pose2& truth_W, double gate_m) {
  std::size_t known = 0;
  for (const core::ScanLandmark& l : landmarks) {
    double d2 = 0.0;
    const core::Point2 p_W = truth_W * atlas.graph().body_point(l.position_L);
    known += atlas.graph().index().nearest_within(atlas.home_slot(), p_W, gate_m, d2) !=
             core::LandmarkIndex::kNone;
  }
  return known;
}

void print(const core::Weighed* w, double distance_m) {
  if (w == nullptr) {
    std::printf(",0,,,,,,");
    return;
  }
  const core::Evidence& e = w->evidence;
  std::printf(",%zu,%.2f,%.2f,%.2f,%u/%u,%u/%u,%.3f", w->candidate.matches.size(),
              e.ln_bayes / std::numbers::ln10, e.group_decades, e.contradiction_decades(), e.unmatched,
              e.explored, e.missing, e.in_view, distance_m);
}

class Why {
 public:
  Why(const core::Config& config, const Truth& truth) : config_(config), frames_(truth), pipeline_(config) {}

  void take(const InputScan& scan, const core::ScanView& list_view) {
    const core::Atlas& atlas = *pipeline_.slam().atlas();
    const core::MapEntry* const home = atlas.home();
    const std::uint32_t home_number = home == nullptr ? 0 : home->number;
    const core::MapSlot home_slot = atlas.home_slot();
    const auto truth = frames_.truth_in(home_number, scan.number);
    const std::size_t known =
        home != nullptr && truth ? count_known(atlas, scan.landmarks, *truth, config_.association.tolerance_m)
                                 : 0;
    const double structure = atlas.rates().structure_decades;
    const double sigma_m = atlas.rates().sigma_m(config_.association.tolerance_m / 3.0);
    numbers_.clear();
    for (const core::MapEntry& map : atlas.maps()) {
      numbers_.push_back(map.number);
    }
    const core::ScanTime time{scan.time, scan.time, scan.time, scan.time};
    const core::Fix fix = scan.is_landmark_list
                              ? pipeline_.process_landmarks(scan.landmarks, list_view, time, {})
                              : pipeline_.process(scan.scanlines, time, {});
    frames_.note(atlas, scan.number);
    const auto error = frames_.truth_in(fix.map, scan.number);
    std::printf("%lld,%u,%s,%s,%u,%u,%.2f,%.3f,%zu,", static_cast<long long>(scan.number), fix.landmarks_seen,
                core::to_string(fix.status).data(), core::to_string(fix.reason).data(), fix.map, home_number,
                structure, sigma_m, known);
    if (core::has_pose(fix) && error) {
      std::printf("%.3f,%.2f", (fix.pose_W.translation() - error->translation()).norm(),
                  core::wrap_angle(fix.pose_W.heading_rad - error->heading_rad) / core::kDegree);
    } else {
      std::printf(",");
    }
    print_candidates(atlas, scan.number, home_slot, fix, structure, home != nullptr);
  }

 private:
  void print_candidates(const core::Atlas& atlas, std::int64_t scan, core::MapSlot home, const core::Fix& fix,
                        double structure, bool has_home) {
    const core::Weighed* right = nullptr;
    const core::Weighed* rival = nullptr;
    double right_m = 0.0;
    double rival_m = 0.0;
    for (const core::Weighed& w : atlas.weighed()) {
      const auto truth = frames_.truth_in(numbers_[w.candidate.map], scan);
      if (!truth || w.candidate.matches.size() < 3) {
        continue;
      }
      const bool is_right = is_at(w.candidate.pose_W, *truth);
      if (is_right && w.candidate.map != home) {
        continue;  // the right place, in a local map
      }
      const core::Weighed*& best = is_right ? right : rival;
      if (best == nullptr || w.evidence.ln_bayes > best->evidence.ln_bayes) {
        best = &w;
        (is_right ? right_m : rival_m) = (w.candidate.pose_W.translation() - truth->translation()).norm();
      }
    }
    const bool is_searched = has_home && !atlas.weighed().empty();
    const core::Verdict verdict = is_searched ? core::decide(atlas.weighed(), home, core::Stake::Fix,
                                                             fix.search_end, structure, config_.acceptance)
                                              : core::Verdict{};
    std::printf(",%s", core::to_string(verdict.reason).data());
    print(right, right_m);
    if (right != nullptr) {
      std::printf(",%.3f,%.2f", core::position_sigma_m(right->evidence.covariance),
                  std::sqrt(right->evidence.covariance(2, 2)) / core::kDegree);
    } else {
      std::printf(",,");
    }
    print(rival, rival_m);
    std::printf(",%d\n", rival != nullptr && rival->candidate.map != home ? 1 : 0);
  }

  core::Config config_;
  Frames frames_;
  firmware::Pipeline pipeline_;
  std::vector<std::uint32_t> numbers_;  // of the maps before the scan, by slot
};

int fail(std::string_view message) {
  std::fprintf(stderr, "truth_why: %.*s\n", static_cast<int>(message.size()), message.data());
  return 1;
}

int run(std::string_view config_file, const std::filesystem::path& truth_file,
        const std::vector<std::filesystem::path>& inputs) {
  const auto loaded = config_file == "-" ? firmware::load_config_text("", "defaults")
                                         : firmware::load_config(std::filesystem::path(config_file));
  if (!loaded) {
    return fail(firmware::error_lines(loaded.error()));
  }
  const auto poses = read_tum(truth_file);
  if (!poses) {
    return fail(poses.error().message);
  }
  Truth truth;
  for (const TimedPose& pose : *poses) {
    truth.emplace(std::llround(pose.t), pose.pose);
  }
  const auto source = open_scans(inputs, loaded->config);
  if (!source) {
    return fail(source.error().message);
  }
  std::printf("scan,landmarks,status,reason,map,home,structure,sigma_m,known,error_m,turn_deg,says");
  std::printf(
      ",r_matches,r_decades,r_groups,r_against,r_unmatched,r_missing,r_error_m,r_sigma_m,r_sigma_deg");
  std::printf(",w_matches,w_decades,w_groups,w_against,w_unmatched,w_missing,w_error_m,w_is_local\n");
  Why why(loaded->config.core, truth);
  while (true) {
    const auto scan = (*source)->next();
    if (scan && !*scan) {
      return 0;
    }
    if (scan) {
      why.take(**scan, loaded->config.landmark_list.view());
    }
  }
}

}  // namespace
}  // namespace slamsensor::tools

int main(int count, char** arguments) {
  if (count < 4) {
    std::fprintf(stderr, "usage: truth_why CONFIG.toml|- TRUTH.tum INPUT...\n");
    return 64;
  }
  return slamsensor::tools::run(arguments[1], arguments[2], {arguments + 3, arguments + count});
}
