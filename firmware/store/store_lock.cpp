#include "firmware/store/store_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace slamsensor::firmware {

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
