#pragma once

#include <cstdint>
#include <cstring>
#include <liblzf/lzf.h>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A PCD file's bytes: the header for `points` points of the given field lines, then `body`.
inline std::string pcd_file(std::string_view fields, std::string_view size, std::string_view type,
                            std::string_view count, std::size_t points, std::string_view data,
                            std::string_view body) {
  const std::string number = std::to_string(points);
  std::string file = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n";
  file.append("FIELDS ").append(fields).append("\nSIZE ").append(size).append("\nTYPE ").append(type);
  file.append("\nCOUNT ").append(count).append("\nWIDTH ").append(number).append("\nHEIGHT 1\n");
  file.append("VIEWPOINT 0 0 0 1 0 0 0\nPOINTS ").append(number).append("\nDATA ").append(data);
  return file.append("\n").append(body);
}

/// A PCD file of three floats x y z per point.
inline std::string pcd_xyz(std::size_t points, std::string_view data, std::string_view body) {
  return pcd_file("x y z", "4 4 4", "F F F", "1 1 1", points, data, body);
}

/// Appends the bytes of `value` as this machine holds it.
template <typename T>
void append_value(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

/// `bytes` in the LZF format.
inline std::string pack_lzf(std::string_view bytes) {
  std::string packed(bytes.size() + bytes.size() / 16 + 64, '\0');
  packed.resize(lzf_compress(bytes.data(), static_cast<unsigned>(bytes.size()), packed.data(),
                             static_cast<unsigned>(packed.size())));
  return packed;
}

/// What follows `DATA binary_compressed`: both sizes, then `fields` packed.
inline std::string compressed_body(std::string_view fields) {
  const std::string packed = pack_lzf(fields);
  std::string body;
  append_value(body, static_cast<std::uint32_t>(packed.size()));
  append_value(body, static_cast<std::uint32_t>(fields.size()));
  return body + packed;
}

}  // namespace slamsensor::tools
