#pragma once

#include "tools/input/text.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace slamsensor::tools {

enum class CsvNeed : std::uint8_t { Required, Optional };

/// A column that a reader knows.
struct CsvColumn {
  std::string_view name;
  CsvNeed need = CsvNeed::Required;
};

/// The first line of a table, as spreadsheets and programs write it.
struct CsvHeader {
  char separator = ',';  ///< between fields; where it is no comma, numbers may have decimal commas
  std::vector<std::string_view> columns;
};

/// Reads the header at `lines`: what parts its columns is found from it (a semicolon, a tab or a comma), or
/// from a line `sep=;` before it. Nothing when there is no line.
[[nodiscard]] std::optional<CsvHeader> read_csv_header(LineReader& lines);

enum class CsvOthers : std::uint8_t { Refused, Ignored };

/// What a value must be: finite and from `min` to `max`; `unit` is for the message ("m").
struct CsvRange {
  double min;
  double max;
  std::string_view unit;
};

/// Walks a table in text: a header that names the columns in any order, then rows with a field per column,
/// parted by commas, semicolons or tabs. Fields are trimmed and may be in double quotes; blank lines, '#'
/// comments, a byte order mark and both line ends are understood. Columns are addressed by their place in the
/// `columns` given to `open`. Text, name and columns must outlive it.
class CsvReader {
 public:
  /// Reads the header. An error when there is none, a required column is missing, one occurs twice, or, where
  /// others are refused, one is not known.
  [[nodiscard]] static tl::expected<CsvReader, InputError> open(std::string_view text, std::string_view name,
                                                                std::span<const CsvColumn> columns,
                                                                CsvOthers others);

  [[nodiscard]] bool has(std::size_t column) const { return places_[column] != kAbsent; }

  /// Moves on to the next row; false at the end. An error when it has more or fewer fields than the header,
  /// or the text ends in it, without a line end and within its last number, as can be told where all numbers
  /// of that column have equally many decimals.
  [[nodiscard]] tl::expected<bool, InputError> next();

  /// The current row's field in a column that `has`.
  [[nodiscard]] std::string_view text(std::size_t column) const { return fields_[places_[column]]; }

  /// That field as a number within `range`; otherwise an error with the line, the value and what is allowed.
  [[nodiscard]] tl::expected<double, InputError> number(std::size_t column, const CsvRange& range) const;

  /// That field as an integer from 0 to `max`; otherwise an error.
  [[nodiscard]] tl::expected<std::int64_t, InputError> whole_number(std::size_t column,
                                                                    std::int64_t max) const;

  [[nodiscard]] std::size_t line() const { return lines_.number(); }

 private:
  static constexpr std::size_t kNumbersToTell = 3;  // fewer may have equally many decimals by chance
  static constexpr std::size_t kAbsent = std::numeric_limits<std::size_t>::max();

  CsvReader(std::string_view text, std::string_view name, std::span<const CsvColumn> columns);
  [[nodiscard]] tl::expected<void, InputError> read_header(std::string_view text, CsvOthers others);
  [[nodiscard]] tl::expected<void, InputError> place_column(std::size_t field, CsvOthers others);
  [[nodiscard]] bool is_cut_off();

  LineReader lines_;
  std::string_view name_;
  std::span<const CsvColumn> columns_;
  std::vector<std::size_t> places_;  // of each column: its field, or kAbsent
  std::vector<std::string_view> fields_;
  char separator_ = ',';
  std::size_t width_ = 0;
  std::size_t numbers_ = 0;             // in the last column
  std::size_t decimals_min_ = kAbsent;  // of the numbers in the last column
  std::size_t decimals_max_ = 0;
};

/// Calls `take_row()` (which returns tl::expected<void, InputError>) on each row that is left, up to the
/// first error, which is returned.
template <typename TakeRow>
[[nodiscard]] tl::expected<void, InputError> for_each_row(CsvReader& csv, TakeRow&& take_row) {
  for (;;) {
    auto more = csv.next();
    if (!more) {
      return tl::unexpected(std::move(more.error()));
    }
    if (!*more) {
      return {};
    }
    if (tl::expected<void, InputError> taken = take_row(); !taken) {
      return taken;
    }
  }
}

}  // namespace slamsensor::tools
