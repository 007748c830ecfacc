#include "tests/support/no_alloc_scope.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SLAMSENSOR_OTHER_HEAP
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define SLAMSENSOR_OTHER_HEAP
#endif
#endif

namespace {

constinit thread_local std::uint64_t calls = 0;

}  // namespace

#ifndef SLAMSENSOR_OTHER_HEAP

// The C library's own heap, under the names that it keeps for those who replace the public ones. C++'s
// operators new and delete arrive here too: libstdc++ makes them of malloc, aligned_alloc and free.
extern "C" {

void* __libc_malloc(std::size_t bytes) noexcept;
void* __libc_calloc(std::size_t count, std::size_t bytes) noexcept;
void* __libc_realloc(void* block, std::size_t bytes) noexcept;
void* __libc_memalign(std::size_t alignment, std::size_t bytes) noexcept;
void __libc_free(void* block) noexcept;

void* malloc(std::size_t bytes) noexcept {
  ++calls;
  return __libc_malloc(bytes);
}

void* calloc(std::size_t count, std::size_t bytes) noexcept {
  ++calls;
  return __libc_calloc(count, bytes);
}

void* realloc(void* block, std::size_t bytes) noexcept {
  ++calls;
  return __libc_realloc(block, bytes);
}

void* reallocarray(void* block, std::size_t count, std::size_t bytes) noexcept {
  ++calls;
  std::size_t product = 0;
  if (__builtin_mul_overflow(count, bytes, &product)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_realloc(block, product);
}

void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  ++calls;
  return __libc_memalign(alignment, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  ++calls;
  return __libc_memalign(alignment, bytes);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) noexcept {
  ++calls;
  if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0 || alignment == 0) {
    return EINVAL;
  }
  void* const taken = __libc_memalign(alignment, bytes);
  if (taken == nullptr) {
    return ENOMEM;
  }
  *block = taken;
  return 0;
}

void free(void* block) noexcept {
  ++calls;
  __libc_free(block);
}

}  // extern "C"

#endif

namespace slamsensor::tests {

bool NoAllocScope::works() noexcept {
#ifdef SLAMSENSOR_OTHER_HEAP
  return false;
#else
  return true;
#endif
}

NoAllocScope::NoAllocScope() noexcept : before_(calls) {
}

std::uint64_t NoAllocScope::heap_calls() const noexcept {
  return calls - before_;
}

}  // namespace slamsensor::tests
