#pragma once

#include "tools/emulator/rangefinder/lwnx_product.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::tools {

/// What an ASCII command asks for (LW20/SF20 manual, appendix C; SF11 manual, appendix E).
enum class LwnxTextKind : std::uint8_t {
  Product,   ///< ? and ?P
  Distance,  ///< ?L, ?LD, ?LDF,0, ?LDL,1, LD
  Strength,  ///< ?LH
  Temperature,
  Baud,  ///< ?CB and #CB,6
  Save,  ///< %P, %C
  Stop,  ///< $ alone ends a text stream
};

struct LwnxTextCommand {
  LwnxTextKind kind = LwnxTextKind::Product;
  char prefix = '?';         ///< ? read, # set, $ stream, % save
  std::string key;           ///< as it was written, in capitals: "LDF"
  std::optional<int> value;  ///< behind the comma
};

/// The command in `line`, which has no line end; nothing when the devices know no such command.
[[nodiscard]] std::optional<LwnxTextCommand> parse_text_command(std::string_view line);

/// The answer to `command` with `value` in it, CR LF at its end: "ldf,0:12.34" or "?LD 12.34".
[[nodiscard]] std::string text_answer(LwnxTextStyle style, const LwnxTextCommand& command,
                                      std::string_view value);

/// The answer to a command that asks for the product: "p:SF20,1.0.0,11".
[[nodiscard]] std::string product_answer(const LwnxProduct& product);

/// `range_m` as the devices write it: "12.34".
[[nodiscard]] std::string metres_text(double range_m);

/// A bare distance with its line end, as the single character d is answered: "78.32".
[[nodiscard]] std::string legacy_distance(double range_m);

}  // namespace slamsensor::tools
