#pragma once

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <span>
#include <string>
#include <sys/types.h>
#include <vector>

namespace slamsensor::firmware {

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

struct FileBytes {
  FileIdentity identity;
  std::vector<std::uint8_t> bytes;
};

/// The whole of a regular file of at most `size_max` bytes. Links are not followed, and nothing that is not a
/// regular file is waited for.
[[nodiscard]] tl::expected<FileBytes, IoError> read_regular(const std::filesystem::path& path,
                                                            std::size_t size_max);

/// A new file at `path` holds `bytes`, on the disk. What was there by that name is gone; after an error
/// nothing is there.
[[nodiscard]] tl::expected<FileIdentity, IoError> write_durably(const std::filesystem::path& path,
                                                                std::span<const std::uint8_t> bytes);

/// All changes of names in `folder` so far are on the disk.
[[nodiscard]] tl::expected<void, IoError> sync_folder(const std::filesystem::path& folder);

}  // namespace slamsensor::firmware
