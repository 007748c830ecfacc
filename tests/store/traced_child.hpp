#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tests {

/// How a child process fared whose every system call was seen.
struct Traced {
  std::size_t stops = 0;             ///< entries and exits of system calls, in all or until it was killed
  bool was_killed = false;           ///< before it ended by itself
  int exit_status = -1;              ///< when it was not
  std::vector<std::string> changes;  ///< calls that change or sync files, in order: "rename a b", "fsync a";
                                     ///< file names without folders
};

/// Runs `work` in a child and kills it with SIGKILL as it enters (even) or leaves (odd) its system call
/// number `kill_at` / 2; at the end of `work` its result is the exit status. None when the system forbids
/// tracing.
[[nodiscard]] std::optional<Traced> run_traced(const std::function<int()>& work,
                                               std::optional<std::size_t> kill_at = std::nullopt);

/// From now on this process is told that the file system has no hard links (EPERM). False when the system
/// does not allow that.
[[nodiscard]] bool forbid_hard_links();

}  // namespace slamsensor::tests
