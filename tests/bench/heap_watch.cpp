#include "tests/bench/heap_watch.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <malloc.h>
#include <string.h>

// glibc's allocator under the names that stay its own when a program brings its own malloc.
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* block);
}

namespace slamsensor::bench {
namespace {

std::atomic<bool> watching{false};
std::atomic<std::uint64_t> allocations{0};
std::atomic<std::int64_t> live_bytes{0};
std::atomic<std::int64_t> peak_bytes{0};

void* note_taken(void* block) noexcept {
  if (watching.load(std::memory_order_relaxed)) {
    allocations.fetch_add(1, std::memory_order_relaxed);
    const auto bytes = static_cast<std::int64_t>(malloc_usable_size(block));
    const std::int64_t live = live_bytes.fetch_add(bytes, std::memory_order_relaxed) + bytes;
    std::int64_t peak = peak_bytes.load(std::memory_order_relaxed);
    while (live > peak && !peak_bytes.compare_exchange_weak(peak, live, std::memory_order_relaxed)) {
    }
  }
  return block;
}

void note_given_back(void* block) noexcept {
  if (watching.load(std::memory_order_relaxed)) {
    live_bytes.fetch_sub(static_cast<std::int64_t>(malloc_usable_size(block)), std::memory_order_relaxed);
  }
}

}  // namespace

HeapWatch::HeapWatch() noexcept {
  allocations = 0;
  live_bytes = 0;
  peak_bytes = 0;
  watching = true;
}

HeapWatch::~HeapWatch() {
  watching = false;
}

HeapUse HeapWatch::use() const noexcept {
  return {allocations.load(), static_cast<std::size_t>(std::max<std::int64_t>(0, peak_bytes.load()))};
}

bool heap_watch_works() {
  const HeapWatch watch;
  std::free(strdup("allocated in the C library"));
  return watch.use().allocations == 1 && watch.use().peak_bytes > 0;
}

}  // namespace slamsensor::bench

// The program's malloc family: what the dynamic linker gives to every library it loads.
extern "C" {

void* malloc(std::size_t bytes) noexcept {
  return slamsensor::bench::note_taken(__libc_malloc(bytes));
}

void* calloc(std::size_t count, std::size_t bytes) noexcept {
  return slamsensor::bench::note_taken(__libc_calloc(count, bytes));
}

void* realloc(void* block, std::size_t bytes) noexcept {
  slamsensor::bench::note_given_back(block);
  return slamsensor::bench::note_taken(__libc_realloc(block, bytes));
}

void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  return slamsensor::bench::note_taken(__libc_memalign(alignment, bytes));
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  return memalign(alignment, bytes);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) noexcept {
  if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0) {
    return EINVAL;
  }
  *block = memalign(alignment, bytes);
  return *block == nullptr ? ENOMEM : 0;
}

void free(void* block) noexcept {
  slamsensor::bench::note_given_back(block);
  __libc_free(block);
}

}  // extern "C"
