#pragma once

#include "core/association/fast_search.hpp"
#include "core/association/graph_search.hpp"
#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/decision/decision.hpp"
#include "core/decision/evidence.hpp"
#include "core/decision/explored_ground.hpp"
#include "core/decision/rates.hpp"
#include "core/decision/scan_view.hpp"
#include "core/fix.hpp"
#include "core/mapping/map_state.hpp"
#include "core/mapping/sighting_graph.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"
#include "core/reading.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

/// A place where a local map may lie: the paper's hypothesis (II-D). W is the accumulated match count of the
/// scans that say so.
struct PlaceHypothesis {
  MapSlot target = 0;
  Pose2 T_target_map;
  std::uint64_t W = 0;
  std::uint32_t scans = 0;  ///< that say so by several groups of landmarks which nothing contradicts
  double decades = 0.0;     ///< by which those scans say so
};

/// One of the maps that are kept. Home or local.
struct MapEntry {
  static constexpr std::size_t kPlacesMax = kHypothesesMax;

  std::uint32_t number = 0;  ///< from 1 on, in the order of their making; 0: not in use
  std::uint32_t scans = 0;   ///< that were brought into it
  std::uint32_t last_scan = 0;
  std::uint32_t landmarks = 0;
  std::uint32_t confirmed = 0;  ///< landmarks that a second scan saw
  std::uint64_t W = 0;          ///< accumulated match count
  Pose2 last_pose;
  double frame_turn2 = 0.0;  ///< variance (rad^2) of the heading of the scan that it began with
  std::uint32_t last_place = SightingGraph::kNone;  ///< of last_pose in the graph
  std::uint32_t follows =
      0;                ///< number of the home map, when the scan before the first one of this was in it
  PlaceHypothesis tie;  ///< where its confirmed landmarks as a whole were believed last, W times in a row
  FixedVector<PlaceHypothesis, kPlacesMax> places;  ///< the best W first
  /// It may be two places in one: a scan that showed again what the scan before showed in it would have been
  /// ambiguous.
  bool is_doubtful = false;
};

/// All that the sensor remembers, and how a scan changes it (DESIGN 2.5): the home map, local maps that are
/// not yet tied to it, and the hypotheses of where those may lie. A scan that is believed in the home map is
/// a fix and extends it. One that is not is held against the local maps, and starts one when it is believed
/// in none. A local map whose confirmed landmarks as a whole are believed in another map becomes part of that
/// map. One thread; no allocation after construction.
class Atlas {
 public:
  static constexpr std::size_t kMapsMax = SightingGraph::kMapsMax;

  Atlas(Arena& arena, const Config& config) noexcept;

  /// Localises the scan and brings it into the maps. `landmarks` come heaviest first. Fix::time is the
  /// caller's.
  [[nodiscard]] Fix process(std::span<const ScanLandmark> landmarks, const ScanView& view,
                            const Deadline& deadline) noexcept;

  /// Forgets everything; the next scan starts a new map, unless frozen.
  void reset() noexcept;
  [[nodiscard]] MapCheck restore(const MapState& state) noexcept;
  /// Makes landmarks that somebody else surveyed (W, m, on the lattice) the home map, with a size of each or
  /// no sizes. False, and the map is empty, when they are more than there is room for.
  [[nodiscard]] bool take_survey(std::span<const Point2> landmarks_W,
                                 std::span<const LandmarkSize> sizes = {}) noexcept;
  /// A survey that may grow is a survey no more: what it leaves out may be there.
  void set_frozen(Frozen frozen) noexcept {
    frozen_ = frozen;
    is_surveyed_ = is_surveyed_ && frozen == Frozen::Yes;
  }
  [[nodiscard]] Frozen frozen() const noexcept { return frozen_; }

  /// All of the home map that cannot be computed again, into `room`, whose spans are at least as long as the
  /// capacities; the answer's spans are parts of them. Takes time in proportion to the map.
  [[nodiscard]] MapState copy_home(const MapRoom& room) const noexcept;
  /// Grows whenever a map changes, and never falls.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
  [[nodiscard]] std::span<const MapEntry> maps() const noexcept { return maps_; }
  /// The home map; null while there is none.
  [[nodiscard]] const MapEntry* home() const noexcept { return home_ == kNoMap ? nullptr : &maps_[home_]; }
  [[nodiscard]] MapSlot home_slot() const noexcept { return home_; }
  [[nodiscard]] std::uint32_t scans() const noexcept { return scans_; }
  [[nodiscard]] const SightingGraph& graph() const noexcept { return graph_; }
  [[nodiscard]] const Rates& rates() const noexcept { return rates_; }
  [[nodiscard]] std::uint64_t landmarks_evicted() const noexcept { return landmarks_evicted_; }
  /// Scans that were brought into a map and taken out again, because later scans contradict them.
  [[nodiscard]] std::uint64_t scans_taken_out() const noexcept { return scans_taken_out_; }
  /// The places of the last search, the best first, for those who show them.
  [[nodiscard]] std::span<const Weighed> weighed() const noexcept { return weighed_.span(); }

 private:
  /// 1 sigma, along each axis, of a landmark's place in the frame of its map.
  [[nodiscard]] double landmark_sigma_m(std::uint32_t slot) const noexcept;

  struct Scan {
    std::uint32_t number = 0;
    const ScanView* view = nullptr;
    double reach_m = 0.0;
  };

  void take_landmarks(std::span<const ScanLandmark> landmarks) noexcept;
  [[nodiscard]] MatchModel scan_model() const noexcept;
  /// Whether a clear leader ends the search.
  enum class Rivals : std::uint8_t { WhereLikely, All };
  void search(const Deadline& deadline, Rivals rivals, Fix& fix) noexcept;
  void find(std::span<const Point2> points, MapSlot except, const MatchModel& model,
            const Deadline& deadline) noexcept;
  void weigh(const Witnesses& witnesses, const Candidates& found, BoundedVector<Weighed>& weighed) noexcept;
  void look_for_layers(const Deadline& deadline, Fix& fix) noexcept;
  void localise(const Deadline& deadline, Fix& fix) noexcept;
  [[nodiscard]] std::optional<std::size_t> best_local() const noexcept;
  [[nodiscard]] double home_share(MapSlot local) const noexcept;
  [[nodiscard]] Stake stake_of(MapSlot map) const noexcept;
  void describe(const Weighed& weighed, Fix& fix) const noexcept;
  void add_common_errors(MapSlot map, const MatchList& matches, Fix& fix) const noexcept;
  void extend(const Weighed& weighed) noexcept;
  void refine_with(const Weighed& weighed, std::uint32_t xi) noexcept;
  void step_map(const Weighed& weighed, MapSlot map) noexcept;
  void note_places(MapSlot map, const Pose2& T_map_B) noexcept;
  [[nodiscard]] Verdict decide_in(MapSlot map, Stake stake, SearchEnd end) noexcept;
  [[nodiscard]] bool is_same_place(const Candidate& a, const Candidate& b) const noexcept;
  [[nodiscard]] std::span<const PathPose> copy_path(std::span<PathPose> path) const noexcept;
  [[nodiscard]] bool is_new_spot(const Weighed& weighed) noexcept;
  void learn_from(const Weighed& weighed) noexcept;
  void learn_spread(const Weighed& weighed) noexcept;
  void learn_sizes() noexcept;
  [[nodiscard]] bool is_sure_in(MapSlot map, SearchEnd end) noexcept;
  void found_home() noexcept;
  void found_home_with(MapSlot map, Fix& fix) noexcept;
  [[nodiscard]] MapSlot keep_locally(const Weighed& chosen, bool is_answer, Fix& fix) noexcept;
  void learn_structure(std::size_t chosen, std::uint32_t news) noexcept;
  [[nodiscard]] bool is_contradicted(const GraphLandmark& landmark, const Standing& standing,
                                     double range_m) const noexcept;
  void look_for_missing(const Weighed& weighed) noexcept;
  std::uint32_t update_matched(const Weighed& weighed, std::array<std::uint32_t, 3>& parents) noexcept;
  void look_around(MapSlot map, const Pose2& T_W_B) noexcept;
  void start_map(Fix& fix) noexcept;
  [[nodiscard]] MapSlot free_map() noexcept;
  void drop_map(MapSlot map) noexcept;
  void count_out(std::uint32_t slot) noexcept;
  void make_room(std::uint32_t wanted) noexcept;
  [[nodiscard]] std::uint32_t least_useful_in_turn() noexcept;
  [[nodiscard]] bool is_known_without_copies() const noexcept;
  /// How far the sensor sees, a share of which is the size of groups; 0 until the world is known: before, a
  /// copy may fill the view.
  [[nodiscard]] double known_reach_m() const noexcept {
    return is_known_without_copies() ? sensor_reach_m_ : 0.0;
  }
  /// Whether `map` may be two places in one. Such a map is neither tied nor a home map, until the world is
  /// known.
  [[nodiscard]] bool is_in_doubt(const MapEntry& map) const noexcept {
    return map.is_doubtful && !is_known_without_copies();
  }
  [[nodiscard]] bool deserves_home(const MapEntry& map) const noexcept;
  void choose_home() noexcept;
  void try_tie(MapSlot map, const Deadline& deadline) noexcept;
  [[nodiscard]] bool tie_by_scans(MapSlot map) noexcept;
  [[nodiscard]] bool tie_by_one_scan(MapSlot map) noexcept;
  [[nodiscard]] bool tie_at(MapSlot map, const PlaceHypothesis& place) noexcept;
  void confirm_tie(MapSlot map, const Weighed& weighed) noexcept;
  [[nodiscard]] MatchList twins_of(MapSlot map, const Weighed& weighed) const noexcept;
  void tie(MapSlot map, const Weighed& weighed) noexcept;
  [[nodiscard]] bool close_loop(MapSlot map) noexcept;
  [[nodiscard]] bool is_linking() const noexcept { return linking_scans_ > 0; }
  [[nodiscard]] double log10_layers_by_chance(MapSlot map, const Pose2& pose_W, std::span<const Match> others,
                                              double apart_m) const noexcept;
  [[nodiscard]] bool is_layer(const Weighed& answer, const Weighed& other) noexcept;
  void link_layers(const Candidate& answer, const Candidate& other) noexcept;
  void count_as_one(MapEntry& entry, std::uint32_t a, std::uint32_t b) const noexcept;
  std::uint32_t unite(std::uint32_t a, std::uint32_t b) noexcept;
  void unite_twins_in_turn() noexcept;
  void probe_structure() noexcept;
  [[nodiscard]] Maps maps_view() const noexcept {
    return {graph_.index(), graph_.positions(), graph_.standing(), ground_, rates_};
  }
  [[nodiscard]] Witnesses scan_witnesses() const noexcept;

  Config config_;
  Pose2 T_L_B_;
  SightingGraph graph_;
  ExploredGround ground_;
  FastSearch fast_;
  std::optional<GraphSearch> by_graph_;  // only where the paper's search is chosen
  BoundedVector<std::uint32_t> slots_;   // of one map, for it
  EvidenceScale scale_;
  Rates rates_;
  std::array<MapEntry, kMapsMax> maps_{};
  MapSlot home_ = kNoMap;
  bool is_surveyed_ = false;  // frozen, and complete
  Pose2 learned_at_;          // in the map of the last scan that the rates were learned from
  MapSlot learned_in_ = kNoMap;
  bool learns_ = true;
  bool is_home_replaced_ = false;   // since the last reset, after it had given a fix
  bool has_fixed_ = false;          // in the present home map
  BoundedVector<Point2> points_L_;  // of the scan
  BoundedVector<Point2> points_B_;
  BoundedVector<LandmarkSize> sizes_;
  BoundedVector<SightingGraph::Seen> seen_;
  BoundedVector<Point2> confirmed_;  // of a local map that is to be tied
  BoundedVector<std::uint32_t> confirmed_slots_;
  BoundedVector<LandmarkSize> confirmed_sizes_;
  BoundedVector<Candidates> found_;  // one
  BoundedVector<Weighed> weighed_;
  BoundedVector<Weighed> weighed_ties_;
  BoundedVector<PathPose> path_before_;  // of the map that was restored, from before that
  std::uint32_t restored_map_ = 0;       // its number
  Scan scan_;
  double sensor_reach_m_ = 0.0;  // the second farthest landmark of any scan: one may be nothing
  std::array<bool, kScanLandmarksMax>
      was_unseen_{};               // per landmark of the scan: what it matches was not seen for long
  std::uint32_t blind_scans_ = 0;  // in a row, of too few landmarks, before this one
  std::uint32_t closed_scan_ = 0;  // that closed a loop last
  std::uint32_t steps_due_ = 0;
  std::uint32_t linking_scans_ = 0;  // for which layers that were linked are still coming together
  std::uint32_t scans_since_step_ = 0;
  std::uint32_t twin_turn_ = 0;
  std::uint32_t room_turn_ = 0;
  Counters counters_;
  Frozen frozen_ = Frozen::No;
  std::uint64_t revision_ = 0;
  std::uint64_t landmarks_evicted_ = 0;
  std::uint64_t scans_taken_out_ = 0;
  std::uint32_t scans_ = 0;
  std::uint32_t jumps_ = 0;
  std::uint32_t maps_made_ = 0;
};

}  // namespace slamsensor::core
