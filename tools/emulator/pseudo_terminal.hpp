#pragma once

#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace slamsensor::tools {

/// A pseudo-terminal with a stable name, a symbolic link, that a host opens like a serial port. The terminal
/// changes no byte. Unplugged it is gone, name and all; plugged in again it is a new one of the same name.
class PseudoTerminal {
 public:
  /// Plugged in at `name`, which is the link from then on; refused when a terminal cannot be had, or when
  /// `name` is anything but a link that an earlier emulator left.
  [[nodiscard]] static tl::expected<std::unique_ptr<PseudoTerminal>, WorldError> create(
      const std::filesystem::path& name);

  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// Unplugs.
  ~PseudoTerminal();

  void unplug() noexcept;

  /// False when the system has no terminal, or the name cannot be made; try again later.
  bool plug_in() noexcept;

  [[nodiscard]] bool is_plugged() const noexcept { return fd_ >= 0; }

  /// The device's end, to wait on; -1 while unplugged.
  [[nodiscard]] int fd() const noexcept { return fd_; }

  /// Whether a host has the port open.
  [[nodiscard]] bool has_host() const noexcept;

  /// The line rate that the host has set, bit/s, whatever the rate; nothing while unplugged.
  [[nodiscard]] std::optional<std::uint32_t> host_baud() const noexcept;

  /// What the host has written; how many bytes. Does not wait.
  std::size_t read(std::span<std::uint8_t> into) noexcept;

  /// Gives bytes to the host; how many it had room for. Does not wait.
  std::size_t write(std::span<const std::uint8_t> bytes) noexcept;

  [[nodiscard]] const std::filesystem::path& name() const noexcept { return name_; }

 private:
  explicit PseudoTerminal(std::filesystem::path name) : name_(std::move(name)) {}

  [[nodiscard]] std::string open_terminal() noexcept;
  [[nodiscard]] std::string make_link() noexcept;

  std::filesystem::path name_;
  std::string target_;  // the terminal that the link leads to
  int fd_ = -1;
};

}  // namespace slamsensor::tools
