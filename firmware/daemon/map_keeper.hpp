#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/control/control_request.hpp"
#include "firmware/daemon/sensor_threads.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "firmware/store/map_store.hpp"
#include "firmware/supervision/log.hpp"
#include "hal/stamp.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// Whether the map may change.
enum class MapMode : std::uint8_t { Growing, Frozen };

/// The supervisor's hand on the map: loads it at start, saves it when it has changed, and carries out what
/// the control socket asks. A map that cannot be read or written is reported and never ends the daemon. One
/// thread, which waits for the disk but not for the SLAM thread.
class MapKeeper {
 public:
  /// An answer to a request that could not be answered at once.
  struct Answer {
    ControlToken token = 0;
    ControlResult result;
  };
  /// Gets each order that the SLAM thread has carried out, for a recording.
  using OrderTap = std::function<void(MapCommand, const SlamAnswer&)>;

  /// `config`, `threads` and `log` outlive this.
  MapKeeper(const Config& config, SensorThreads& threads, Log& log, hal::Stamp now);

  /// Has the SLAM thread go on from the stored map, if there is a good one.
  void load_at_start();
  /// Gets the SLAM thread's answer, saves what is due; the answers that are ready now.
  [[nodiscard]] std::vector<Answer> step(const OutputTime& now);
  /// Saves what is not saved: before the end, when the SLAM thread has stopped.
  void save_at_end(const OutputTime& now);
  /// Saves what is not saved, and logs the result.
  void save_now(const OutputTime& now);

  /// The settings have changed; map.frozen counts with the next step.
  void on_new_config();
  void set_order_tap(OrderTap tap) { tap_ = std::move(tap); }

  // Requests of the control socket. An empty name is that of the map in use.
  [[nodiscard]] ControlResult list();
  [[nodiscard]] ControlResult info();
  /// The landmarks of the map in use, a line of its names first.
  [[nodiscard]] ControlResult landmarks();
  [[nodiscard]] ControlResult save(std::string_view name, const OutputTime& now);
  [[nodiscard]] ControlResult remove(std::string_view name);
  [[nodiscard]] ControlOutcome load(ControlToken token, std::string_view name);
  [[nodiscard]] ControlOutcome reset(ControlToken token, const OutputTime& now);
  [[nodiscard]] ControlOutcome set_mode(ControlToken token, MapMode mode, const OutputTime& now);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::optional<hal::Stamp> saved() const { return saved_; }
  [[nodiscard]] bool is_unsaved() const;
  [[nodiscard]] bool is_frozen() const { return is_frozen_; }
  /// Loads and resets so far.
  [[nodiscard]] std::uint32_t replaced() const { return replaced_; }
  /// That the map in use was saved with.
  [[nodiscard]] const std::optional<Datum>& datum() const { return about_.datum; }
  /// The map as its file, for a recording; empty when there is none.
  [[nodiscard]] std::vector<std::uint8_t> encoded();

 private:
  struct Pending {
    MapCommand kind = MapCommand::Reset;
    ControlToken token = 0;  // 0: nobody waits for an answer
    std::string name;
    std::optional<LoadedMap> map;
  };

  [[nodiscard]] bool give(Pending pending);
  [[nodiscard]] ControlOutcome ask(Pending pending);
  [[nodiscard]] bool is_published(const SlamAnswer& answer) const;
  void finish_order(hal::Stamp now);
  [[nodiscard]] ControlResult carried_out(const Pending& pending, const SlamAnswer& answer, hal::Stamp now);
  [[nodiscard]] bool is_replacing() const;
  [[nodiscard]] tl::expected<std::string, StoreError> store(const std::string& name, const OutputTime& now);
  void forget_map(std::uint64_t revision);
  [[nodiscard]] std::uint64_t revision() const;

  const Config& config_;
  SensorThreads& threads_;
  Log& log_;
  MapStore store_;
  AutosavePolicy policy_;
  std::string name_;
  MapAbout about_;
  std::optional<hal::Stamp> saved_;
  std::optional<Pending> pending_;
  std::optional<SlamAnswer> answer_;    // to it
  std::optional<MapMode> mode_wanted_;  // by a changed setting
  std::uint64_t valid_from_ = 0;        // maps of earlier revisions are those before the last load or reset
  std::uint32_t replaced_ = 0;
  bool is_frozen_;
  bool is_frozen_set_;  // by the settings
  OrderTap tap_;
  std::vector<Answer> answers_;
};

}  // namespace slamsensor::firmware
