#include "tests/store/traced_child.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <string_view>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

namespace slamsensor::tests {
namespace {

using SyscallInfo = __ptrace_syscall_info;

/// The C string at `address` of the process; what cannot be read of it is left out. The heap moves from run
/// to run, so a string may go on in the next page.
std::string text_at(pid_t process, std::uint64_t address) {
  constexpr std::uint64_t kPage = 4096;
  std::string text;
  while (text.size() < kPage) {
    const std::uint64_t from = address + text.size();
    std::array<char, kPage> bytes{};
    iovec local{bytes.data(), static_cast<std::size_t>(kPage - from % kPage)};
    iovec remote{reinterpret_cast<void*>(from), local.iov_len};  // NOLINT: an address of another process
    const ssize_t count = ::process_vm_readv(process, &local, 1, &remote, 1, 0);
    if (count <= 0) {
      break;
    }
    const auto size = static_cast<std::size_t>(count);
    const std::size_t length = ::strnlen(bytes.data(), size);
    text.append(bytes.data(), length);
    if (length < size) {
      break;
    }
  }
  return text;
}

std::string file_at(pid_t process, std::uint64_t address) {
  return std::filesystem::path(text_at(process, address)).filename().string();
}

std::string file_of(pid_t process, std::uint64_t descriptor) {
  std::error_code error;
  return std::filesystem::read_symlink(
             "/proc/" + std::to_string(process) + "/fd/" + std::to_string(descriptor), error)
      .filename()
      .string();
}

/// The call in words when it changes or syncs a file; empty when not.
std::string describe(pid_t process, const SyscallInfo& info) {
  const auto& args = info.entry.args;
  switch (info.entry.nr) {
    case SYS_write:
      return "write " + file_of(process, args[0]);
    case SYS_fsync:
      return "fsync " + file_of(process, args[0]);
#ifdef SYS_rename
    case SYS_rename:
      return "rename " + file_at(process, args[0]) + ' ' + file_at(process, args[1]);
    case SYS_link:
      return "link " + file_at(process, args[0]) + ' ' + file_at(process, args[1]);
    case SYS_unlink:
      return "unlink " + file_at(process, args[0]);
#endif
    case SYS_renameat:
    case SYS_renameat2:
      return "rename " + file_at(process, args[1]) + ' ' + file_at(process, args[3]);
    case SYS_linkat:
      return "link " + file_at(process, args[1]) + ' ' + file_at(process, args[3]);
    case SYS_unlinkat:
      return "unlink " + file_at(process, args[1]);
    default:
      return {};
  }
}

[[noreturn]] void run_child(const std::function<int()>& work) {
  if (::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) {
    ::_exit(77);
  }
  ::raise(SIGSTOP);
  ::_exit(work());
}

/// One stop of the child. False when it has ended.
bool handle_stop(pid_t child, int status, std::optional<std::size_t> kill_at, Traced& result) {
  if (WIFEXITED(status) || WIFSIGNALED(status)) {
    result.was_killed = WIFSIGNALED(status);
    result.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return false;
  }
  if (WSTOPSIG(status) != (SIGTRAP | 0x80)) {
    ::ptrace(PTRACE_SYSCALL, child, nullptr, WSTOPSIG(status) == SIGSTOP ? 0 : WSTOPSIG(status));
    return true;
  }
  if (kill_at && result.stops == *kill_at) {
    ::kill(child, SIGKILL);
    return true;
  }
  ++result.stops;
  SyscallInfo info{};
  if (::ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof info, &info) > 0 &&
      info.op == PTRACE_SYSCALL_INFO_ENTRY) {
    if (std::string change = describe(child, info); !change.empty()) {
      result.changes.push_back(std::move(change));
    }
  }
  ::ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
  return true;
}

}  // namespace

std::optional<Traced> run_traced(const std::function<int()>& work, std::optional<std::size_t> kill_at) {
  const pid_t child = ::fork();
  if (child == 0) {
    run_child(work);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child || !WIFSTOPPED(status)) {
    return std::nullopt;
  }
  ::ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
  ::ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
  Traced result;
  while (::waitpid(child, &status, 0) == child && handle_stop(child, status, kill_at, result)) {
  }
  return result;
}

bool forbid_hard_links() {
#ifdef SYS_link
  constexpr std::uint32_t kLink = SYS_link;
#else
  constexpr std::uint32_t kLink = SYS_linkat;
#endif
  std::array<sock_filter, 5> program{{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, 0),  // the number of the call
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kLink, 1, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_linkat, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  }};
  sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

}  // namespace slamsensor::tests
