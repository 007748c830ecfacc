#pragma once

#include "firmware/config/load_config.hpp"

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// Collects the rules between keys that a configuration breaks. A rule names its keys, first the one whose
/// value is called wrong.
class Rules {
 public:
  /// Rules about a key that `known` names are left out. Both outlive this.
  Rules(const LoadedConfig& loaded, const std::vector<ConfigError>& known) : loaded_(loaded), known_(known) {}

  /// `what` stands in the message between the value of the first key and those of the others.
  void require(bool holds, std::initializer_list<std::string_view> keys, const std::string& what);

  /// A driver refuses `section` (or one key), for the reason `what`, which is told at the key that it names.
  /// Left out when a mistake of the section is known already.
  void refuse_section(std::string_view section, const std::string& what);

  [[nodiscard]] const Config& config() const { return loaded_.config; }
  [[nodiscard]] std::vector<ConfigError> take_errors() { return std::move(errors_); }

 private:
  [[nodiscard]] bool is_known(std::string_view key) const;
  [[nodiscard]] std::string value(std::string_view key) const;

  const LoadedConfig& loaded_;
  const std::vector<ConfigError>& known_;
  std::vector<ConfigError> errors_;
};

/// The rules of the method, of the sensor head, and of the daemon's own affairs.
void check_method(Rules& rules);
void check_head(Rules& rules);
void check_daemon(Rules& rules);

}  // namespace slamsensor::firmware
