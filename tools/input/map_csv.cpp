#include "tools/input/map_csv.hpp"

#include "core/graph/delaunay.hpp"
#include "tools/input/csv.hpp"
#include "tools/input/file.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <unordered_map>

namespace slamsensor::tools {
namespace {

enum Column : std::size_t { kId, kX, kY };
constexpr std::array<CsvColumn, 3> kColumns{{{"id"}, {"x_m"}, {"y_m"}}};
constexpr CsvRange kPlace{-core::kLatticeReach_m, core::kLatticeReach_m, "m"};

tl::expected<MapPoint, InputError> parse_row(const CsvReader& csv) {
  const auto id = csv.whole_number(kId, std::numeric_limits<std::int64_t>::max());
  if (!id) {
    return tl::unexpected(id.error());
  }
  const auto x_m = csv.number(kX, kPlace);
  if (!x_m) {
    return tl::unexpected(x_m.error());
  }
  const auto y_m = csv.number(kY, kPlace);
  if (!y_m) {
    return tl::unexpected(y_m.error());
  }
  return MapPoint{*id, {*x_m, *y_m}};
}

}  // namespace

tl::expected<std::vector<MapPoint>, InputError> parse_map_csv(std::string_view text, std::string_view name) {
  auto csv = CsvReader::open(text, name, kColumns, CsvOthers::Ignored);
  if (!csv) {
    return tl::unexpected(std::move(csv.error()));
  }
  std::vector<MapPoint> rows;
  std::unordered_map<std::int64_t, std::size_t> line_of_id;
  const auto take_row = [&]() -> tl::expected<void, InputError> {
    auto row = parse_row(*csv);
    if (!row) {
      return tl::unexpected(std::move(row.error()));
    }
    const auto [seen, fresh] = line_of_id.try_emplace(row->id, csv->line());
    if (!fresh) {
      return refuse_line(name, csv->line(),
                         "id " + std::to_string(row->id) + " is already in line " +
                             std::to_string(seen->second) + "; give each landmark its own");
    }
    rows.push_back(*row);
    return {};
  };
  if (auto taken = for_each_row(*csv, take_row); !taken) {
    return tl::unexpected(std::move(taken.error()));
  }
  if (rows.empty()) {
    return refuse(name, "holds no landmark; a row id,x_m,y_m is needed for each");
  }
  return rows;
}

tl::expected<std::vector<MapPoint>, InputError> read_map_csv(const std::filesystem::path& path) {
  return read_file(path).and_then(
      [&](const std::string& text) { return parse_map_csv(text, path.string()); });
}

}  // namespace slamsensor::tools
