#pragma once

#include <cstdint>
#include <cstring>
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

/// `bytes` in the LZF format, searched naively: copies where at least three bytes repeat, literals elsewhere.
inline std::string pack_lzf(std::string_view bytes) {
  std::string packed;
  std::string literals;
  const auto flush = [&] {
    for (std::size_t at = 0; at < literals.size(); at += 32) {
      const std::string part = literals.substr(at, 32);
      packed += static_cast<char>(part.size() - 1);
      packed += part;
    }
    literals.clear();
  };
  for (std::size_t at = 0; at < bytes.size();) {
    std::size_t best_length = 0;
    std::size_t best_distance = 0;
    for (std::size_t distance = 1; distance <= at && distance <= 8192; ++distance) {
      std::size_t length = 0;
      while (length < 264 && at + length < bytes.size() &&
             bytes[at + length] == bytes[at + length - distance]) {
        ++length;
      }
      if (length > best_length) {
        best_length = length;
        best_distance = distance;
      }
    }
    if (best_length < 3) {
      literals += bytes[at++];
      continue;
    }
    flush();
    const std::size_t length = best_length - 2;
    const std::size_t offset = best_distance - 1;
    packed += static_cast<char>((length < 7 ? length : 7) << 5U | offset >> 8U);
    if (length >= 7) {
      packed += static_cast<char>(length - 7);
    }
    packed += static_cast<char>(offset & 0xFFU);
    at += best_length;
  }
  flush();
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
