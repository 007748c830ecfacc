#include "tools/input/csv.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace slamsensor::tools {
namespace {

std::string column_list(std::span<const CsvColumn> columns) {
  std::string list;
  for (const CsvColumn& column : columns) {
    list += list.empty() ? "" : ",";
    list += column.name;
    list += column.need == CsvNeed::Optional ? " (optional)" : "";
  }
  return list;
}

// A field without the quotes around it; a quote within stays, and is then no number and no column's name.
std::string_view unquoted(std::string_view field) {
  field = trim(field);
  const bool is_quoted = field.size() >= 2 && field.front() == '"' && field.back() == '"';
  return is_quoted ? trim(field.substr(1, field.size() - 2)) : field;
}

// Where the field at the start of `line` ends: at a separator outside of quotes, or at the line's end.
std::size_t field_end(std::string_view line, char separator) {
  bool in_quotes = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    in_quotes = in_quotes != (line[i] == '"');
    if (line[i] == separator && !in_quotes) {
      return i;
    }
  }
  return std::string_view::npos;
}

void split_line(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const std::size_t end = field_end(line, separator);
    fields.push_back(unquoted(line.substr(0, end)));
    if (end == std::string_view::npos) {
      return;
    }
    line.remove_prefix(end + 1);
  }
}

char separator_of(std::string_view header) {
  for (const char separator : {';', '\t'}) {
    if (header.find(separator) != std::string_view::npos) {
      return separator;
    }
  }
  return ',';
}

// After the point (or comma) of a number.
std::size_t decimals_of(std::string_view number) {
  const std::size_t point = number.find_first_of(".,");
  return point == std::string_view::npos ? 0 : number.size() - point - 1;
}

// A number with a decimal comma, which is one only where no comma parts the fields.
std::optional<double> parse_decimal(std::string_view text, char separator) {
  const std::size_t comma = separator == ',' ? std::string_view::npos : text.find(',');
  if (comma == std::string_view::npos || text.find('.') != std::string_view::npos) {
    return parse_number(text);
  }
  std::string with_point(text);
  with_point[comma] = '.';
  return parse_number(with_point);
}

}  // namespace

std::optional<CsvHeader> read_csv_header(LineReader& lines) {
  constexpr std::string_view kSeparatorLine = "sep=";  // the first line of what a spreadsheet wrote
  if (!lines.next()) {
    return std::nullopt;
  }
  CsvHeader header;
  header.separator = separator_of(lines.line());
  if (lines.line().starts_with(kSeparatorLine) && lines.whole_line().size() == kSeparatorLine.size() + 1) {
    header.separator = lines.whole_line().back();
    if (!lines.next()) {
      return std::nullopt;
    }
  }
  split_line(lines.whole_line(), header.separator, header.columns);
  return header;
}

CsvReader::CsvReader(std::string_view text, std::string_view name, std::span<const CsvColumn> columns)
    : lines_(text), name_(name), columns_(columns), places_(columns.size(), kAbsent) {
}

tl::expected<CsvReader, InputError> CsvReader::open(std::string_view text, std::string_view name,
                                                    std::span<const CsvColumn> columns, CsvOthers others) {
  CsvReader reader(text, name, columns);
  if (auto read = reader.read_header(text, others); !read) {
    return tl::unexpected(std::move(read.error()));
  }
  return reader;
}

tl::expected<void, InputError> CsvReader::read_header(std::string_view text, CsvOthers others) {
  if (auto checked = check_encoding(text, name_); !checked) {
    return checked;
  }
  auto header = read_csv_header(lines_);
  if (!header) {
    return refuse(name_, "is empty; its first line must name the columns " + column_list(columns_));
  }
  separator_ = header->separator;
  fields_ = std::move(header->columns);
  width_ = fields_.size();
  for (std::size_t field = 0; field < width_; ++field) {
    if (auto placed = place_column(field, others); !placed) {
      return placed;
    }
  }
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    if (columns_[column].need == CsvNeed::Required && !has(column)) {
      return refuse_line(name_, line(),
                         "has no column " + std::string(columns_[column].name) +
                             "; the first line must name the columns " + column_list(columns_));
    }
  }
  return {};
}

tl::expected<void, InputError> CsvReader::place_column(std::size_t field, CsvOthers others) {
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    if (columns_[column].name != fields_[field]) {
      continue;
    }
    if (has(column)) {
      return refuse_line(name_, line(),
                         "names the column " + in_quotes(fields_[field]) + " twice; remove one");
    }
    places_[column] = field;
    return {};
  }
  if (others == CsvOthers::Refused) {
    return refuse_line(
        name_, line(),
        "column " + in_quotes(fields_[field]) + " is not known; allowed are " + column_list(columns_));
  }
  return {};
}

tl::expected<bool, InputError> CsvReader::next() {
  if (!lines_.next()) {
    return false;
  }
  split_line(lines_.whole_line(), separator_, fields_);
  if (fields_.size() != width_) {
    return refuse_line(name_, line(),
                       "has " + std::to_string(fields_.size()) + " fields where the header has " +
                           std::to_string(width_) + ": " + in_quotes(lines_.line()));
  }
  if (is_cut_off()) {
    return refuse_line(name_, line(),
                       "the file ends within the number " + in_quotes(fields_.back()) +
                           ": it has fewer decimals than all above it, and no line end follows; copy the "
                           "file again, or remove the line");
  }
  return true;
}

/// Whether the text ends within the last number of the row.
bool CsvReader::is_cut_off() {
  const std::string_view last = fields_.back();
  if (last.empty()) {
    return false;
  }
  const std::size_t decimals = decimals_of(last);
  const bool are_all_alike = numbers_ >= kNumbersToTell && decimals_min_ == decimals_max_;
  if (!lines_.ended() && are_all_alike && decimals < decimals_min_) {
    return true;
  }
  ++numbers_;
  decimals_min_ = std::min(decimals_min_, decimals);
  decimals_max_ = std::max(decimals_max_, decimals);
  return false;
}

tl::expected<double, InputError> CsvReader::number(std::size_t column, const CsvRange& range) const {
  const std::optional<double> value = parse_decimal(text(column), separator_);
  if (!value || !std::isfinite(*value) || *value < range.min || *value > range.max) {
    return refuse_line(name_, line(),
                       std::string(columns_[column].name) + " is " + in_quotes(text(column)) +
                           "; allowed is a number from " + shown(range.min) + " to " + shown(range.max) +
                           (range.unit.empty() ? "" : " ") + std::string(range.unit));
  }
  return *value;
}

tl::expected<std::int64_t, InputError> CsvReader::whole_number(std::size_t column, std::int64_t max) const {
  const std::optional<std::int64_t> value = parse_integer(text(column));
  if (!value || *value < 0 || *value > max) {
    return refuse_line(name_, line(),
                       std::string(columns_[column].name) + " is " + in_quotes(text(column)) +
                           "; allowed is a whole number from 0 to " + std::to_string(max));
  }
  return *value;
}

}  // namespace slamsensor::tools
