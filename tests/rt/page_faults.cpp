#include "tests/rt/page_faults.hpp"

#include <cstddef>
#include <fstream>
#include <string>
#include <sys/mman.h>
#include <sys/resource.h>

namespace slamsensor::tests {
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
