#include "tools/output/map_csv.hpp"

#include "tools/output/number_text.hpp"

namespace slamsensor::tools {
namespace {

void append_row(std::string& out, const MapRow& row) {
  append_integer(out, row.id);
  out += ',';
  append_fixed(out, row.position_W.x(), 6);
  out += ',';
  append_fixed(out, row.position_W.y(), 6);
  for (const std::uint32_t count : {row.xi, row.sightings}) {
    out += ',';
    append_integer(out, count);
  }
  for (const std::int64_t scan : {row.first_scan, row.last_scan}) {
    out += ',';
    append_integer(out, scan);
  }
  out += '\n';
}

}  // namespace

std::string format_map(std::span<const MapRow> rows) {
  std::string out = "id,x_m,y_m,xi,sightings,first_scan,last_scan\n";
  for (const MapRow& row : rows) append_row(out, row);
  return out;
}

tl::expected<void, OutputError> write_map(const std::filesystem::path& path, std::span<const MapRow> rows) {
  return write_file(path, format_map(rows));
}

}  // namespace slamsensor::tools
