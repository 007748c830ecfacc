#pragma once

#include "firmware/store/store_io.hpp"

#include <tl/expected.hpp>

#include <filesystem>
#include <utility>

namespace slamsensor::firmware {

/// Holds a folder for one process: a flock on the file `.lock` in it, given back at the end of life or of the
/// process, however that ends.
class StoreLock {
 public:
  /// `error` is EWOULDBLOCK when another process holds the folder.
  [[nodiscard]] static tl::expected<StoreLock, IoError> acquire(const std::filesystem::path& folder);

  StoreLock(StoreLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  StoreLock& operator=(StoreLock&& other) noexcept {
    std::swap(file_, other.file_);
    return *this;
  }
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;
  ~StoreLock();

 private:
  explicit StoreLock(int file) : file_(file) {}

  int file_;
};

}  // namespace slamsensor::firmware
