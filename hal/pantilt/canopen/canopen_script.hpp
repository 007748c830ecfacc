#pragma once

#include "hal/pantilt/canopen/canopen_problem.hpp"
#include "hal/pantilt/canopen/sdo_client.hpp"

#include <optional>

namespace slamsensor::hal {

/// A part of a node's start-up: requests one after the other, each depending on what was answered.
class CanopenScript {
 public:
  CanopenScript() = default;
  CanopenScript(const CanopenScript&) = delete;
  CanopenScript& operator=(const CanopenScript&) = delete;
  virtual ~CanopenScript() = default;

  /// Starts over.
  virtual void begin(Stamp now) noexcept = 0;

  /// The request that is due; nothing when all are done. Must not change what it depends on.
  [[nodiscard]] virtual std::optional<SdoRequest> next() const noexcept = 0;

  /// Takes the answer to next(), which is Done or Aborted; anything but None ends the start-up.
  [[nodiscard]] virtual CanopenProblem on_result(const SdoResult& result, const SdoClient& client,
                                                 Stamp now) noexcept = 0;
};

}  // namespace slamsensor::hal
