#include "tools/input/csv.hpp"

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

}  // namespace

CsvReader::CsvReader(std::string_view text, std::string_view name, std::span<const CsvColumn> columns)
    : lines_(text), name_(name), columns_(columns), places_(columns.size(), kAbsent) {
}

tl::expected<CsvReader, InputError> CsvReader::open(std::string_view text, std::string_view name,
                                                    std::span<const CsvColumn> columns, CsvOthers others) {
  CsvReader reader(text, name, columns);
  if (auto read = reader.read_header(others); !read) {
    return tl::unexpected(std::move(read.error()));
  }
  return reader;
}

tl::expected<void, InputError> CsvReader::read_header(CsvOthers others) {
  if (!lines_.next()) {
    return refuse(name_, "is empty; its first line must name the columns " + column_list(columns_));
  }
  split_line();
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

void CsvReader::split_line() {
  fields_.clear();
  std::string_view rest = lines_.line();
  for (;;) {
    const std::size_t comma = rest.find(',');
    fields_.push_back(trim(rest.substr(0, comma)));
    if (comma == std::string_view::npos) {
      return;
    }
    rest.remove_prefix(comma + 1);
  }
}

tl::expected<bool, InputError> CsvReader::next() {
  if (!lines_.next()) {
    return false;
  }
  split_line();
  if (fields_.size() != width_) {
    return refuse_line(name_, line(),
                       "has " + std::to_string(fields_.size()) + " fields where the header has " +
                           std::to_string(width_) + ": " + in_quotes(lines_.line()));
  }
  return true;
}

tl::expected<double, InputError> CsvReader::number(std::size_t column, const CsvRange& range) const {
  const std::optional<double> value = parse_number(text(column));
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
