#pragma once

#include "firmware/supervision/file_descriptor.hpp"
#include "hal/init_error.hpp"

#include <tl/expected.hpp>

#include <string>
#include <sys/types.h>

namespace slamsensor::firmware {

/// A local stream socket that listens at a path. The path goes with it, unless another has taken it over.
class ControlListener {
 public:
  /// Listens at `path` with mode 0660. A socket that a dead process left there is replaced; one that answers,
  /// or a file of another kind, is left alone and refused. The error says what to do.
  [[nodiscard]] static tl::expected<ControlListener, hal::InitError> create(const std::string& path);

  ControlListener(ControlListener&& other) noexcept = default;
  ControlListener& operator=(ControlListener&& other) = delete;
  ~ControlListener();

  [[nodiscard]] int fd() const noexcept { return socket_.get(); }

  /// The next client, its socket non-blocking; none when there is none (errno says whether it went wrong).
  [[nodiscard]] FileDescriptor accept() noexcept;

 private:
  ControlListener(FileDescriptor socket, std::string path);

  FileDescriptor socket_;
  std::string path_;
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

}  // namespace slamsensor::firmware
