#pragma once

#include <array>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <span>
#include <stdexcept>
#include <stdlib.h>
#include <string>
#include <unistd.h>
#include <vector>

namespace slamsensor::tests {

/// The far end of a pseudo-terminal whose near end has a stable path, as a udev link has: unplugged and
/// plugged in again it is another terminal behind the same path.
class PseudoTerminal {
 public:
  PseudoTerminal() : folder_(make_folder()), path_(folder_ / "port") { plug_in(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;
  ~PseudoTerminal() {
    unplug();
    std::filesystem::remove_all(folder_);
  }

  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] int master() const { return master_; }

  void plug_in() {
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    std::array<char, 64> name{};
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
        ::ptsname_r(master_, name.data(), name.size()) != 0) {
      throw std::runtime_error("no pseudo-terminal can be had");
    }
    std::filesystem::create_symlink(name.data(), path_);
  }

  void unplug() {
    if (master_ >= 0) {
      std::filesystem::remove(path_);
      ::close(master_);
      master_ = -1;
    }
  }

  void write(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::write(master_, bytes.data(), bytes.size());
      if (sent <= 0) {
        throw std::runtime_error("the pseudo-terminal takes no more");
      }
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
  }

  [[nodiscard]] std::vector<std::uint8_t> read() {
    std::vector<std::uint8_t> bytes(8192);
    const ssize_t count = ::read(master_, bytes.data(), bytes.size());
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
  }

 private:
  static std::filesystem::path make_folder() {
    std::string name = (std::filesystem::temp_directory_path() / "slamsensor-pty-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("no temporary folder can be made");
    }
    return name;
  }

  std::filesystem::path folder_;
  std::filesystem::path path_;
  int master_ = -1;
};

}  // namespace slamsensor::tests
