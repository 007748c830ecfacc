#include "tools/map_files/open_map.hpp"

#include "firmware/store/map_file.hpp"
#include "firmware/store/map_names.hpp"
#include "firmware/store/map_store.hpp"
#include "firmware/store/store_io.hpp"

#include <system_error>

namespace slamsensor::tools {
namespace {

tl::expected<OpenedMap, std::string> read_map(const std::filesystem::path& path) {
  const auto content = firmware::read_regular(path, firmware::kMapFileBytesMax);
  if (!content) {
    return tl::unexpected(path.string() + ": " + content.error().text());
  }
  auto map = firmware::decode_map(content->bytes, firmware::unlimited_capacities());
  if (!map) {
    return tl::unexpected(path.string() + ": " + map.error().message);
  }
  return OpenedMap{std::move(*map), path, content->bytes.size(), {}};
}

}  // namespace

tl::expected<OpenedMap, std::string> open_map(const std::string& name, const std::filesystem::path& folder) {
  std::error_code ignored;
  if (std::filesystem::exists(name, ignored) || !firmware::is_map_name(name)) {
    return read_map(name);
  }
  const firmware::MapStore store(folder, firmware::unlimited_capacities());
  auto loaded = store.load(name);
  if (!loaded) {
    const bool is_missing = loaded.error().fault == firmware::StoreFault::Missing;
    return tl::unexpected(loaded.error().message +
                          (is_missing ? "; name a file, or another store with --store FOLDER" : ""));
  }
  const std::size_t bytes = std::filesystem::file_size(loaded->path, ignored);
  return OpenedMap{std::move(loaded->file), loaded->path, bytes, loaded->warning};
}

}  // namespace slamsensor::tools
