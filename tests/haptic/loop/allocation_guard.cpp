#include "tests/haptic/loop/allocation_guard.h"

#include <atomic>
#include <cerrno>
#include <cstddef>

namespace fettle::tests {

namespace {

thread_local int t_guards = 0;
std::atomic<std::uint64_t> g_calls{0};

bool forbidden() noexcept {
  if (t_guards == 0) return false;
  g_calls.fetch_add(1, std::memory_order_relaxed);
  errno = ENOMEM;
  return true;
}

}  // namespace

AllocationGuard::AllocationGuard() noexcept {
  ++t_guards;
}
AllocationGuard::~AllocationGuard() {
  --t_guards;
}
std::uint64_t AllocationGuard::calls() noexcept {
  return g_calls.load(std::memory_order_relaxed);
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
bool allocationGuardWorks() noexcept {
  static_cast<void>(&forbidden);
  return false;
}
}  // namespace fettle::tests
#else
bool allocationGuardWorks() noexcept {
  return true;
}
}  // namespace fettle::tests

// glibc lets a program replace the whole family; its own functions stay reachable by these names.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) {
  return fettle::tests::forbidden() ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  return fettle::tests::forbidden() ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  return fettle::tests::forbidden() ? nullptr : __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  return fettle::tests::forbidden() ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  *out = memalign(alignment, size);
  return *out == nullptr ? ENOMEM : 0;
}
void free(void* memory) {
  // Counted, but done: what is freed must not leak into the test's own verdict.
  static_cast<void>(memory != nullptr && fettle::tests::forbidden());
  __libc_free(memory);
}
}
#endif
