#pragma once

#include "firmware/control/control_target.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace slamsensor::firmware {

/// A daemon that notes what it is asked, answers "done" at once, or later when the test says so.
class FakeControlTarget final : public ControlTarget {
 public:
  enum class Manner { AtOnce, Later, Refusing, Throwing };

  Manner manner = Manner::AtOnce;
  SensorStatus current;
  std::vector<std::string> asked;    ///< "map_load shed"
  std::vector<ControlToken> tokens;  ///< of what is to be answered later
  ControlReply reply{"done", {}};

  [[nodiscard]] const SensorStatus& status() override { return current; }
  [[nodiscard]] std::string version() const override { return "slamsensord 1.2.3"; }

  ControlOutcome scan_now(ControlToken t) override { return note(t, "scan_now"); }
  ControlOutcome scan_pause(ControlToken t) override { return note(t, "scan_pause"); }
  ControlOutcome scan_resume(ControlToken t) override { return note(t, "scan_resume"); }
  ControlOutcome scan_mode(ControlToken t, ScanMode mode) override {
    return note(t, mode == ScanMode::Single ? "scan_mode single" : "scan_mode continuous");
  }
  ControlOutcome map_list(ControlToken t) override { return note(t, "map_list"); }
  ControlOutcome map_info(ControlToken t) override { return note(t, "map_info"); }
  ControlOutcome map_save(ControlToken t, std::string_view name) override {
    return note(t, "map_save", name);
  }
  ControlOutcome map_load(ControlToken t, std::string_view name) override {
    return note(t, "map_load", name);
  }
  ControlOutcome map_remove(ControlToken t, std::string_view name) override {
    return note(t, "map_remove", name);
  }
  ControlOutcome map_reset(ControlToken t) override { return note(t, "map_reset"); }
  ControlOutcome map_mode(ControlToken t, MapMode mode) override {
    return note(t, mode == MapMode::Frozen ? "map_mode frozen" : "map_mode growing");
  }
  ControlOutcome datum_show(ControlToken t) override { return note(t, "datum_show"); }
  ControlOutcome datum_set(ControlToken t, const Datum& datum) override {
    last_datum = datum;
    return note(t, "datum_set");
  }
  ControlOutcome datum_clear(ControlToken t) override { return note(t, "datum_clear"); }
  ControlOutcome config_get(ControlToken t, std::string_view key) override {
    return note(t, "config_get", key);
  }
  ControlOutcome config_set(ControlToken t, std::string_view key, std::string_view value) override {
    return note(t, "config_set " + std::string(key), value);
  }
  ControlOutcome config_unset(ControlToken t, std::string_view key) override {
    return note(t, "config_unset", key);
  }
  ControlOutcome config_list(ControlToken t) override { return note(t, "config_list"); }
  ControlOutcome config_reload(ControlToken t) override { return note(t, "config_reload"); }
  ControlOutcome record_start(ControlToken t, std::string_view name) override {
    return note(t, "record_start", name);
  }
  ControlOutcome record_stop(ControlToken t) override { return note(t, "record_stop"); }
  ControlOutcome record_status(ControlToken t) override { return note(t, "record_status"); }
  ControlOutcome set_log_level(ControlToken t, LogLevel level) override {
    return note(t, "set_log_level", to_string(level));
  }

  Datum last_datum;

 private:
  ControlOutcome note(ControlToken token, const std::string& what, std::string_view argument = {}) {
    asked.push_back(argument.empty() ? what : what + ' ' + std::string(argument));
    switch (manner) {
      case Manner::AtOnce:
        return reply;
      case Manner::Later:
        tokens.push_back(token);
        return std::nullopt;
      case Manner::Refusing:
        return tl::unexpected(ControlError{ControlErrorCode::Refused, "not now; wait"});
      case Manner::Throwing:
        break;
    }
    throw std::runtime_error("out of ideas");
  }
};

}  // namespace slamsensor::firmware
