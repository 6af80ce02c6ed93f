#pragma once

#include <cstddef>

/// Counts what a thread takes from the heap, by C, by C++ and by Eigen. For one source of a
/// program: it replaces malloc. Under a sanitizer, which has a heap of its own, the count stays 0.

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

thread_local long pliant_allocations = 0;

void* malloc(std::size_t n) {
  ++pliant_allocations;
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) {
  ++pliant_allocations;
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t n) {
  ++pliant_allocations;
  return __libc_realloc(p, n);
}
void* aligned_alloc(std::size_t alignment, std::size_t n) {
  ++pliant_allocations;
  return __libc_memalign(alignment, n);
}
}
namespace pliant {
inline constexpr bool kCountsAllocations = true;
inline long Allocations() { return pliant_allocations; }
}  // namespace pliant
#else
namespace pliant {
inline constexpr bool kCountsAllocations = false;
inline long Allocations() { return 0; }
}  // namespace pliant
#endif
