#pragma once

#include "firmware/store/map_names.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <utility>

namespace slamsensor::firmware {

enum class StoreFault : std::uint8_t {
  Name,     ///< not a name that a map can have, or one that is taken
  Missing,  ///< there is no such map: no reason for alarm at a first start
  Refused,  ///< what is there is no good map, or what is to be saved is none
  Io,       ///< disk full, read-only, not allowed, broken, ...
  InUse,    ///< another process has the folder
  Busy,     ///< not at this moment
};

struct StoreError {
  StoreFault fault = StoreFault::Io;
  std::string message;  ///< what, where and what to do, in one line
};

[[nodiscard]] inline tl::unexpected<StoreError> store_failure(StoreFault fault, std::string message) {
  return tl::unexpected(StoreError{fault, std::move(message)});
}

/// The error that `name` is not `is_map_name`.
[[nodiscard]] inline tl::unexpected<StoreError> bad_map_name(std::string_view name) {
  return store_failure(StoreFault::Name, "map name " + printable_bytes(name) +
                                             ": use 1 to 64 characters out of A-Z, a-z, 0-9, _ and -");
}

/// A system call that failed on a file.
struct IoError {
  std::string step;  ///< "fsync", ...
  int error = 0;     ///< errno; 0: it did not fail, but what it found is of no use, and `step` says what
  std::string advice;

  /// "fsync: No space left on device; free some space on the disk".
  [[nodiscard]] std::string text() const;
};

/// The error of `step` that errno now tells, with what to do about it.
[[nodiscard]] tl::unexpected<IoError> io_failure(std::string step);

/// Which state of which file: another one differs in something here.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  off_t size = 0;
  std::int64_t modified_ns = 0;

  friend bool operator==(const FileIdentity&, const FileIdentity&) = default;
};

/// What is at `path`, links not followed; an error (ENOENT, ...) when nothing is.
[[nodiscard]] tl::expected<FileIdentity, IoError> identify(const std::filesystem::path& path);

/// Memory of its own, which goes back to the system at the end: the heap of a process that keeps all its
/// memory locked would hold it for good.
class OwnPages {
 public:
  OwnPages() = default;
  OwnPages(OwnPages&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
  OwnPages& operator=(OwnPages&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~OwnPages();

  /// ENOMEM or EAGAIN where there is none.
  [[nodiscard]] static tl::expected<OwnPages, IoError> take(std::size_t size);

  [[nodiscard]] std::span<std::uint8_t> bytes() const noexcept { return bytes_; }

 private:
  std::span<std::uint8_t> bytes_;
};

struct FileBytes {
  FileIdentity identity;
  std::span<const std::uint8_t> bytes;  ///< in `pages`
  OwnPages pages;
};

/// The whole of a regular file of at most `size_max` bytes; of one that does not begin with `magic` no more
/// than these first bytes. Links are not followed, and nothing that is not a regular file is waited for.
[[nodiscard]] tl::expected<FileBytes, IoError> read_regular(const std::filesystem::path& path,
                                                            std::size_t size_max,
                                                            std::span<const std::uint8_t> magic = {});

/// A new file at `path` holds `bytes`, on the disk. What was there by that name is gone; after an error
/// nothing is there.
[[nodiscard]] tl::expected<FileIdentity, IoError> write_durably(const std::filesystem::path& path,
                                                                std::span<const std::uint8_t> bytes);

/// All changes of names in `folder` so far are on the disk.
[[nodiscard]] tl::expected<void, IoError> sync_folder(const std::filesystem::path& folder);

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
