#include "firmware/control/control_listener.hpp"

#include "firmware/supervision/unix_address.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <sys/stat.h>

namespace slamsensor::firmware {
namespace {

constexpr mode_t kMode = 0660;
constexpr int kBacklog = 8;
constexpr int kKind = SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK;

enum class Occupant { Nobody, Dead, Alive, OtherFile, Unreachable };

tl::unexpected<hal::InitError> refuse(const std::string& path, const std::string& why) {
  return tl::unexpected(hal::InitError{"control socket " + path + ": " + why});
}

std::string advice(int error) {
  switch (error) {
    case ENOENT:
      return "; make its folder (systemd does with RuntimeDirectory=) or change control.socket";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; make its folder writable for the daemon or change control.socket";
    case EMFILE:
    case ENFILE:
      return "; raise the limit of open files";
    case ENOMEM:
    case ENOBUFS:
      return "; give the daemon more memory";
    default:
      return "; change control.socket";
  }
}

tl::unexpected<hal::InitError> failure(const std::string& path, const char* step, int error) {
  return refuse(path, std::string("cannot be ") + step + ": " + std::strerror(error) + advice(error));
}

Occupant occupant_of(const std::string& path, const UnixAddress& address) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) {
    return errno == ENOENT ? Occupant::Nobody : Occupant::Unreachable;
  }
  if (!S_ISSOCK(status.st_mode)) {
    return Occupant::OtherFile;
  }
  const FileDescriptor probe(::socket(AF_UNIX, kKind, 0));
  if (::connect(probe.get(), address.get(), address.size) == 0 || errno == EAGAIN) {
    return Occupant::Alive;
  }
  return errno == ECONNREFUSED ? Occupant::Dead : Occupant::Unreachable;
}

/// Nobody else of this kind looks at the folder while this lives. Where the folder cannot be locked there is
/// nothing to be had: the binding tells the rest.
FileDescriptor lock_folder(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  FileDescriptor lock(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (lock && ::flock(lock.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    lock.reset();
    errno = EWOULDBLOCK;
  }
  return lock;
}

/// Makes `path` free to be bound.
tl::expected<void, hal::InitError> clear_path(const std::string& path, const UnixAddress& address) {
  switch (occupant_of(path, address)) {
    case Occupant::Nobody:
      return {};
    case Occupant::Dead:
      if (::unlink(path.c_str()) != 0) {
        return failure(path, "removed", errno);
      }
      return {};
    case Occupant::Alive:
      return refuse(path, "another slamsensord answers there; stop it or change control.socket");
    case Occupant::OtherFile:
      return refuse(path, "a file that is no socket is there; remove it or change control.socket");
    case Occupant::Unreachable:
      break;
  }
  return failure(path, "looked at", errno);
}

}  // namespace

ControlListener::ControlListener(FileDescriptor socket, std::string path)
    : socket_(std::move(socket)), path_(std::move(path)) {
  struct stat status {};
  if (::lstat(path_.c_str(), &status) == 0) {
    device_ = status.st_dev;
    inode_ = status.st_ino;
  }
}

ControlListener::~ControlListener() {
  struct stat status {};
  if (socket_ && ::lstat(path_.c_str(), &status) == 0 && status.st_dev == device_ &&
      status.st_ino == inode_) {
    ::unlink(path_.c_str());
  }
}

tl::expected<ControlListener, hal::InitError> ControlListener::create(const std::string& path) {
  const auto address = unix_address(path);
  if (!address || path.front() == '@') {
    return refuse(path, "no path of 1 to " + std::to_string(kUnixPathMax) + " bytes; change control.socket");
  }
  const FileDescriptor lock = lock_folder(path);
  if (!lock && errno == EWOULDBLOCK) {
    return refuse(path, "another slamsensord is starting there; stop it or change control.socket");
  }
  if (const auto cleared = clear_path(path, *address); !cleared) {
    return tl::unexpected(cleared.error());
  }
  FileDescriptor socket(::socket(AF_UNIX, kKind, 0));
  // The mode of the descriptor goes over to the path: at no time may more people connect than in the end.
  if (!socket || ::fchmod(socket.get(), kMode) != 0 ||
      ::bind(socket.get(), address->get(), address->size) != 0) {
    return failure(path, "made", errno);
  }
  ControlListener listener(std::move(socket), path);
  if (::chmod(path.c_str(), kMode) != 0 || ::listen(listener.fd(), kBacklog) != 0) {
    return failure(path, "opened", errno);
  }
  return listener;
}

FileDescriptor ControlListener::accept() noexcept {
  return FileDescriptor(::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
}

}  // namespace slamsensor::firmware
