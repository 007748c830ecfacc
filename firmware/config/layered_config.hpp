#pragma once

#include "firmware/config/load_config.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// A key that has another value than before.
struct ConfigChange {
  std::size_t index = 0;  ///< in settings()
  std::string before;     ///< as the file writes it; "none" while its section is absent
  std::string after;
  Origin origin;  ///< of the new value

  [[nodiscard]] const Setting& setting() const { return settings()[index]; }
  [[nodiscard]] bool is_live() const { return setting().apply == Apply::Live; }
  /// For the log: "nmea.rate_hz 1.0 -> 5.0 (f.toml:12)", and ": needs a restart" behind it where it does.
  [[nodiscard]] std::string text() const;
};

/// Every key that differs, in the order of settings(). Who set it does not count.
[[nodiscard]] std::vector<ConfigChange> changes(const LoadedConfig& before, const LoadedConfig& after);

/// `running` with those values of `wanted` that can change live, their origins, and all of its warnings.
/// Sections that may be absent are so afterwards where they are in `wanted` and live. Rules between keys are
/// not checked.
[[nodiscard]] LoadedConfig with_live_changes(const LoadedConfig& running, const LoadedConfig& wanted);

/// Where a configuration comes from, each laid over the one before: the built-in defaults, a file with its
/// drop-in folder (see apply_files), the command line.
struct ConfigSources {
  std::filesystem::path file;           ///< empty: none
  std::vector<Assignment> settings{};   ///< of the command line
  std::vector<ConfigError> mistakes{};  ///< found before, in the command line; no configuration with one
};

/// What the layers of `sources` come to when they are laid over `base`, the built-in defaults unless another
/// is given; or every mistake of all of them.
[[nodiscard]] tl::expected<LoadedConfig, std::vector<ConfigError>> load_layers(const ConfigSources& sources,
                                                                               LoadedConfig base = {});

/// What a change of the configuration came to.
struct Reconfiguration {
  std::vector<ConfigChange> live;     ///< in force now: to be applied
  std::vector<ConfigChange> pending;  ///< what the layers say and a restart would bring
};

/// The configuration of a running daemon: the layers of its sources, and on top those keys that were set
/// while it runs, which are kept in memory alone. What is in force differs from what the layers say in keys
/// that need a restart. Not for real-time threads.
class LayeredConfig {
 public:
  using Errors = std::vector<ConfigError>;
  using Result = tl::expected<Reconfiguration, Errors>;

  /// Loads the sources; every mistake when there is one.
  [[nodiscard]] static tl::expected<LayeredConfig, Errors> create(ConfigSources sources);

  /// Reads the sources again and lays the runtime layer over them. With a mistake nothing changes, and all
  /// mistakes are returned.
  [[nodiscard]] Result reload();

  /// Adds keys to the runtime layer, all or (with a mistake, or a key that needs a restart) none. The keys
  /// of an absent section are given together.
  [[nodiscard]] Result set(const std::vector<Assignment>& assignments);
  /// Takes a key out of the runtime layer, so that the layers below count again; a mistake when it is not in
  /// it. Any key of a section that was made absent brings the section back.
  [[nodiscard]] Result unset(std::string_view key);
  /// Makes an optional section absent, whatever the layers below say, until one of its keys is set.
  [[nodiscard]] Result set_absent(std::string_view section);

  /// In force.
  [[nodiscard]] const LoadedConfig& current() const { return current_; }
  /// What differs from what is in force since the start and needs a restart.
  [[nodiscard]] std::vector<ConfigChange> pending() const;
  /// The runtime layer, oldest first: keys, and sections that were made absent, without a value.
  [[nodiscard]] const std::vector<Assignment>& runtime() const { return runtime_; }

 private:
  LayeredConfig(ConfigSources sources, LoadedConfig loaded)
      : sources_(std::move(sources)), base_(loaded), current_(std::move(loaded)) {}

  /// Puts `base` under `runtime`, and in force what can be.
  [[nodiscard]] Result adopt(const LoadedConfig& base, Errors errors, std::vector<Assignment> runtime);

  ConfigSources sources_;
  LoadedConfig base_;  ///< the layers below the runtime layer
  LoadedConfig current_;
  std::vector<Assignment> runtime_;
};

}  // namespace slamsensor::firmware
