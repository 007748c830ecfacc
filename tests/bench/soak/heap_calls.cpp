// A library for LD_PRELOAD that counts the heap calls of every thread into the file HEAP_CALLS_FILE: pairs of
// 64-bit numbers, thread and calls. tests/bench/soak/soak reads it while the daemon runs.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace {

struct Slot {
  std::atomic<std::uint64_t> thread;
  std::atomic<std::uint64_t> calls;
};
constexpr std::size_t kSlots = 256;

constinit std::atomic<Slot*> slots{nullptr};
constinit std::atomic<bool> opened{false};
constinit thread_local Slot* mine = nullptr;

Slot* open_slots() {
  const char* const path = std::getenv("HEAP_CALLS_FILE");
  const int fd = path == nullptr ? -1 : open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd < 0 || ftruncate(fd, sizeof(Slot) * kSlots) != 0) {
    return nullptr;
  }
  void* const memory = mmap(nullptr, sizeof(Slot) * kSlots, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  close(fd);
  return memory == MAP_FAILED ? nullptr : static_cast<Slot*>(memory);
}

void count() {
  if (mine == nullptr) {
    if (!opened.exchange(true)) {
      slots = open_slots();
    }
    Slot* const all = slots;
    for (std::size_t i = 0; all != nullptr && i < kSlots && mine == nullptr; ++i) {
      std::uint64_t nobody = 0;
      if (all[i].thread.compare_exchange_strong(nobody, static_cast<std::uint64_t>(gettid()))) {
        mine = &all[i];
      }
    }
  }
  if (mine != nullptr) {
    mine->calls.fetch_add(1, std::memory_order_relaxed);
  }
}

}  // namespace

extern "C" {

void* __libc_malloc(std::size_t bytes) noexcept;
void* __libc_calloc(std::size_t count, std::size_t bytes) noexcept;
void* __libc_realloc(void* block, std::size_t bytes) noexcept;
void* __libc_memalign(std::size_t alignment, std::size_t bytes) noexcept;

void* malloc(std::size_t bytes) noexcept {
  count();
  return __libc_malloc(bytes);
}
void* calloc(std::size_t number, std::size_t bytes) noexcept {
  count();
  return __libc_calloc(number, bytes);
}
void* realloc(void* block, std::size_t bytes) noexcept {
  count();
  return __libc_realloc(block, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  count();
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  count();
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) noexcept {
  count();
  *block = __libc_memalign(alignment, bytes);
  return *block == nullptr ? 12 : 0;  // ENOMEM
}
}
