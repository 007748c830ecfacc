#include "firmware/store/store_io.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <string_view>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace slamsensor::firmware {
namespace {

using Path = std::filesystem::path;

constexpr mode_t kFileMode = 0644;

std::string_view advice_for(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space on the disk";
    case EFBIG:
      return "raise the file size limit of the daemon";
    case EROFS:
      return "make the disk writable, or set map.directory to a folder on another";
    case EACCES:
    case EPERM:
      return "give the daemon's user access to the folder and its files";
    case ENOENT:
    case ENOTDIR:
      return "correct the path, or create the folder";
    case ENXIO:
    case ENODEV:
      return "it is a socket or a device; move it away";
    case ENOMEM:
    case EAGAIN:
      return "give the daemon more memory";
    case ELOOP:
      return "it is a symbolic link; put the file itself there";
    case EISDIR:
      return "it is a folder; move it away";
    case ENAMETOOLONG:
      return "choose a shorter name";
    case EMFILE:
    case ENFILE:
      return "raise the limit of open files";
    default:
      return "check the disk";
  }
}

/// A descriptor that is closed at the end of its scope.
class OwnFile {
 public:
  explicit OwnFile(int file) : file_(file) {}
  OwnFile(const OwnFile&) = delete;
  OwnFile& operator=(const OwnFile&) = delete;
  ~OwnFile() {
    if (file_ >= 0) {
      ::close(file_);
    }
  }
  [[nodiscard]] int get() const { return file_; }
  /// 0, or -1 and errno.
  [[nodiscard]] int close() { return ::close(std::exchange(file_, -1)); }

 private:
  int file_;
};

FileIdentity identity_of(const struct stat& status) {
  return {status.st_dev, status.st_ino, status.st_size,
          std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec};
}

tl::unexpected<IoError> useless(std::string what, std::string advice) {
  return tl::unexpected(IoError{std::move(what), 0, std::move(advice)});
}

tl::expected<void, IoError> write_all(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written < 0) {
      return io_failure("write");
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

/// Fills `bytes` as far as the file goes, and returns how many these are.
tl::expected<std::size_t, IoError> read_all(int file, std::span<std::uint8_t> bytes) {
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t count = ::read(file, bytes.data() + filled, bytes.size() - filled);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count < 0) {
      return io_failure("read");
    }
    if (count == 0) {
      break;
    }
    filled += static_cast<std::size_t>(count);
  }
  return filled;
}

/// Whether the file may go on as one that begins with `magic`: a shorter one is to be read and refused as a
/// whole.
tl::expected<bool, IoError> begins_with(int file, std::span<const std::uint8_t> magic,
                                        std::span<std::uint8_t> bytes) {
  const auto filled = read_all(file, bytes.first(std::min(magic.size(), bytes.size())));
  if (!filled) {
    return tl::unexpected(filled.error());
  }
  return std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(*filled), magic.begin());
}

tl::expected<FileIdentity, IoError> fill_and_close(OwnFile& file, std::span<const std::uint8_t> bytes) {
  if (auto written = write_all(file.get(), bytes); !written) {
    return tl::unexpected(std::move(written.error()));
  }
  if (::fsync(file.get()) != 0) {
    return io_failure("fsync");
  }
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) {
    return io_failure("fstat");
  }
  if (file.close() != 0) {
    return io_failure("close");
  }
  return identity_of(status);
}

}  // namespace

std::string IoError::text() const {
  return step + (error == 0 ? "" : ": " + std::generic_category().message(error)) + "; " + advice;
}

tl::unexpected<IoError> io_failure(std::string step) {
  const int error = errno;
  return tl::unexpected(IoError{std::move(step), error, std::string(advice_for(error))});
}

tl::expected<FileIdentity, IoError> identify(const Path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) {
    return io_failure("lstat");
  }
  return identity_of(status);
}

OwnPages::~OwnPages() {
  if (!bytes_.empty()) {
    ::munmap(bytes_.data(), bytes_.size());
  }
}

tl::expected<OwnPages, IoError> OwnPages::take(std::size_t size) {
  OwnPages pages;
  if (size == 0) {
    return pages;
  }
  void* const memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    return io_failure("no memory for the file");
  }
  pages.bytes_ = {static_cast<std::uint8_t*>(memory), size};
  return pages;
}

tl::expected<FileBytes, IoError> read_regular(const Path& path, std::size_t size_max,
                                              std::span<const std::uint8_t> magic) {
  const OwnFile file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  if (file.get() < 0) {
    return io_failure("open");
  }
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) {
    return io_failure("fstat");
  }
  if (S_ISDIR(status.st_mode)) {
    return useless("it is a folder", "move it away");
  }
  if (!S_ISREG(status.st_mode)) {
    return useless("it is not a regular file", "move it away");
  }
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > size_max) {
    return useless("it has " + std::to_string(size) + " bytes; a map has at most " + std::to_string(size_max),
                   "move it away");
  }
  std::array<std::uint8_t, 64> start{};
  const std::size_t peeked = std::min({magic.size(), start.size(), static_cast<std::size_t>(size)});
  const auto is_wanted = begins_with(file.get(), magic.first(peeked), start);
  if (!is_wanted) {
    return tl::unexpected(is_wanted.error());
  }
  auto pages = OwnPages::take(*is_wanted ? static_cast<std::size_t>(size) : peeked);
  if (!pages) {
    return tl::unexpected(std::move(pages.error()));
  }
  const std::span<std::uint8_t> bytes = pages->bytes();
  std::copy_n(start.begin(), peeked, bytes.begin());
  const auto rest = read_all(file.get(), bytes.subspan(peeked));
  if (!rest) {
    return tl::unexpected(rest.error());
  }
  return FileBytes{identity_of(status), bytes.first(peeked + *rest), std::move(*pages)};
}

tl::expected<FileIdentity, IoError> write_durably(const Path& path, std::span<const std::uint8_t> bytes) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    return io_failure("unlink");
  }
  OwnFile file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kFileMode));
  if (file.get() < 0) {
    return io_failure("open");
  }
  auto written = fill_and_close(file, bytes);
  if (!written) {
    ::unlink(path.c_str());
  }
  return written;
}

tl::expected<void, IoError> sync_folder(const Path& folder) {
  OwnFile file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (file.get() < 0) {
    return io_failure("open of the folder");
  }
  // File systems that cannot do this for a folder say EINVAL: their names are on the disk already, or never
  // surely.
  if (::fsync(file.get()) != 0 && errno != EINVAL) {
    return io_failure("fsync of the folder");
  }
  return {};
}

tl::expected<StoreLock, IoError> StoreLock::acquire(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / ".lock";
  StoreLock lock(::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644));
  if (lock.file_ < 0) {
    return io_failure("open");
  }
  if (::flock(lock.file_, LOCK_EX | LOCK_NB) != 0) {
    return io_failure("flock");
  }
  return lock;
}

StoreLock::~StoreLock() {
  if (file_ >= 0) {
    ::close(file_);
  }
}

}  // namespace slamsensor::firmware
