#include "tests/rt/rehearsal.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <pthread.h>
#include <span>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <sys/resource.h>
#include <system_error>
#include <unistd.h>

namespace slamsensor::tests {
namespace {

using Word = std::uint64_t;
constexpr Word kPaint = 0xA5C3'96E1'5A3C'691E;

/// Memory for a stack above a page that no one may touch.
class StackMemory {
 public:
  explicit StackMemory(std::size_t bytes)
      : guard_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))), bytes_(bytes + guard_) {
    void* const mapped =
        mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK, -1, 0);
    if (mapped == MAP_FAILED || mprotect(mapped, guard_, PROT_NONE) != 0) {
      throw std::runtime_error("no memory for a stack");
    }
    base_ = static_cast<std::byte*>(mapped);
    std::fill(words().begin(), words().end(), kPaint);
  }
  StackMemory(const StackMemory&) = delete;
  StackMemory& operator=(const StackMemory&) = delete;
  ~StackMemory() { munmap(base_, bytes_); }

  [[nodiscard]] std::span<Word> words() const {
    return {reinterpret_cast<Word*>(base_ + guard_), (bytes_ - guard_) / sizeof(Word)};
  }

 private:
  std::size_t guard_;
  std::size_t bytes_;
  std::byte* base_ = nullptr;
};

struct Start {
  const std::function<void()>* work;
  std::uintptr_t top;  // where the stack stood when `work` began
};

void* enter(void* argument) {
  auto& start = *static_cast<Start*>(argument);
  start.top = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0));
  (*start.work)();
  return nullptr;
}

void check(int error, const char* what) {  // pthread calls return the error
  if (error != 0) {
    throw std::system_error(error, std::generic_category(), what);
  }
}

}  // namespace

std::size_t run_on_painted_stack(std::size_t stack_bytes, const std::function<void()>& work) {
  const StackMemory memory(stack_bytes);
  const std::span<Word> words = memory.words();
  Start start{&work, 0};
  pthread_attr_t attributes;
  pthread_t thread;
  check(pthread_attr_init(&attributes), "pthread_attr_init");
  check(pthread_attr_setstack(&attributes, words.data(), words.size_bytes()), "pthread_attr_setstack");
  check(pthread_create(&thread, &attributes, enter, &start), "pthread_create");
  check(pthread_join(thread, nullptr), "pthread_join");
  check(pthread_attr_destroy(&attributes), "pthread_attr_destroy");
  const auto deepest = std::find_if(words.begin(), words.end(), [](Word word) { return word != kPaint; });
  return start.top - reinterpret_cast<std::uintptr_t>(&*deepest);
}

namespace {

std::uint64_t faults_of_thread() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt) + static_cast<std::uint64_t>(usage.ru_majflt);
}

/// Populates one line of the process' list of mappings: "begin-end rwxp ...". True for those that nothing can
/// be read of.
bool populate(const std::string& mapping) {
  std::size_t used = 0;
  const std::uintptr_t begin = std::stoull(mapping, &used, 16);
  std::size_t used_too = 0;
  const std::uintptr_t end = std::stoull(mapping.substr(used + 1), &used_too, 16);
  const std::string rights = mapping.substr(used + 1 + used_too + 1, 4);
  if (rights[0] != 'r' ||
      mapping.find("[v") != std::string::npos) {  // not readable, or the kernel's own (vvar, vdso)
    return true;
  }
  const int advice = rights[1] == 'w' ? MADV_POPULATE_WRITE : MADV_POPULATE_READ;
  return madvise(reinterpret_cast<void*>(begin), end - begin, advice) == 0;
}

}  // namespace

PageFaultScope::PageFaultScope() noexcept : before_(faults_of_thread()) {
}

std::uint64_t PageFaultScope::faults() const noexcept {
  return faults_of_thread() - before_;
}

bool hold_memory() {
  if (mlockall(MCL_CURRENT) == 0) {
    return true;
  }
  std::ifstream mappings("/proc/self/maps");
  std::string mapping;
  bool populated = mappings.is_open();
  while (std::getline(mappings, mapping)) {
    populated = populate(mapping) && populated;
  }
  return populated;
}

}  // namespace slamsensor::tests
