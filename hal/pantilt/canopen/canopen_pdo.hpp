#pragma once

#include "hal/pantilt/canopen/canopen_config.hpp"
#include "hal/pantilt/canopen/canopen_script.hpp"

#include <cstdint>

namespace slamsensor::hal {

/// A process data object as it was agreed on with a node: a word (control or status) and a position.
struct PdoMap {
  bool is_present = false;
  bool is_sync = false;  ///< latched, or acted on, at SYNC
  std::uint32_t cob_id = 0;
  std::uint8_t size = 0;      ///< bytes of the whole
  std::uint8_t word_at = 0;   ///< where its 2 bytes begin
  std::uint8_t value_at = 0;  ///< where its 4 bytes begin
};

enum class PdoDirection : std::uint8_t { Receive, Transmit };  ///< as the node sees it

/// Sets up the first PDO of a direction, or finds one that has what is needed (CiA 301, "PDO configuration").
/// The node is pre-operational.
class CanopenPdoScript final : public CanopenScript {
 public:
  /// Both outlive this.
  CanopenPdoScript(PdoDirection direction, std::uint8_t node, const CanopenConfig& config,
                   CanopenCounters& counters) noexcept
      : direction_(direction), node_(node), config_(config), counters_(counters) {}

  void begin(Stamp now) noexcept override;
  [[nodiscard]] std::optional<SdoRequest> next() const noexcept override;
  [[nodiscard]] CanopenProblem on_result(const SdoResult& result, const SdoClient& client,
                                         Stamp now) noexcept override;

  /// Valid when the script is done.
  [[nodiscard]] const PdoMap& map() const noexcept { return map_; }

 private:
  enum class Step : std::uint8_t {
    Cob,
    Disable,
    Clear,
    Word,
    Value,
    Close,
    Type,
    TypeTold,
    Timer,
    Enable,
    Count,
    Entry,
    Done
  };
  struct Found {
    std::uint8_t count = 0;
    std::uint8_t entry = 0;
    std::uint32_t bits = 0;
    std::optional<std::uint32_t> word_bit;
    std::optional<std::uint32_t> value_bit;
  };

  [[nodiscard]] SdoAddress setting(std::uint8_t sub) const noexcept;
  [[nodiscard]] SdoAddress mapping(std::uint8_t sub) const noexcept;
  [[nodiscard]] std::uint32_t entry_of(Step step) const noexcept;
  [[nodiscard]] std::uint32_t enabled_cob() const noexcept;
  [[nodiscard]] std::uint8_t wanted_type() const noexcept;
  [[nodiscard]] CanopenProblem map_fixed(std::uint32_t code) noexcept;
  void on_setting(const SdoResult& result) noexcept;
  void use_type(std::uint32_t type) noexcept;
  [[nodiscard]] CanopenProblem on_search(const SdoResult& result) noexcept;
  [[nodiscard]] CanopenProblem look_at_next() noexcept;
  [[nodiscard]] bool is_found() const noexcept;

  const PdoDirection direction_;
  const std::uint8_t node_;
  const CanopenConfig& config_;
  CanopenCounters& counters_;
  Step step_ = Step::Done;
  bool is_own_ = true;      // mapped here, not found
  std::uint8_t pdo_ = 0;    // 0: the first
  std::uint32_t told_ = 0;  // COB-ID object as read
  Found found_;
  PdoMap map_;
};

}  // namespace slamsensor::hal
