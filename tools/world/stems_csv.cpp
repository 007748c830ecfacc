#include "tools/world/stems_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

namespace slamsensor::tools {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\"";
  const std::size_t first = text.find_first_not_of(kBlank);
  return first == std::string_view::npos ? std::string_view{}
                                         : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// Cuts the part before the next `mark` off `rest`; the whole of it when there is none.
std::string_view take_until(std::string_view& rest, char mark) {
  const std::size_t end = std::min(rest.find(mark), rest.size());
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (!line.empty()) {
    cells.push_back(trimmed(take_until(line, ',')));
  }
  return cells;
}

std::optional<std::size_t> find_column(const std::vector<std::string_view>& cells, std::string_view name) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string_view word = cells[i].substr(0, cells[i].find(' '));
    if (word == name || (word.size() == name.size() + 2 && word.starts_with(name) && word.ends_with("_m"))) {
      return i;
    }
  }
  return std::nullopt;
}

std::optional<double> number_in(const std::vector<std::string_view>& cells, std::size_t column) {
  double number = 0.0;
  if (column >= cells.size()) {
    return std::nullopt;
  }
  const std::string_view cell = cells[column];
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  const bool whole = error == std::errc{} && end == cell.data() + cell.size();
  return whole && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

}  // namespace

tl::expected<std::vector<core::Point2>, WorldError> parse_stems(std::string_view csv, std::string_view name) {
  std::string_view header = trimmed(take_until(csv, '\n'));
  header.remove_prefix(header.starts_with('#') ? 1 : 0);
  const std::vector<std::string_view> names = cells_of(header);
  const auto x = find_column(names, "x");
  const auto y = find_column(names, "y");
  if (!x || !y) {
    return tl::unexpected(
        WorldError{std::string(name) + ":1: the first line must name columns x and y, or x_m and y_m"});
  }
  std::vector<core::Point2> stems;
  for (std::size_t line = 2; !csv.empty(); ++line) {
    const std::string_view row = trimmed(take_until(csv, '\n'));
    if (row.empty() || row.starts_with('#')) {
      continue;
    }
    const std::vector<std::string_view> cells = cells_of(row);
    const auto x_m = number_in(cells, *x);
    const auto y_m = number_in(cells, *y);
    if (!x_m || !y_m) {
      return tl::unexpected(WorldError{std::string(name) + ":" + std::to_string(line) +
                                       ": no number in column x or y; correct or remove the line"});
    }
    stems.emplace_back(*x_m, *y_m);
  }
  return stems;
}

tl::expected<std::vector<core::Point2>, WorldError> load_stems(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return tl::unexpected(WorldError{path.string() +
                                     ": cannot be opened; trees.stems_csv is looked for in the " +
                                     "folder of the world file"});
  }
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return parse_stems(text, path.string());
}

}  // namespace slamsensor::tools
