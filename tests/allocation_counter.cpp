#include "allocation_counter.h"

#include <atomic>
#include <cstddef>

namespace {
std::atomic<long> count = 0;
}

namespace springstab {
long allocations() { return count; }
}  // namespace springstab

// The names are the linker's: __real_f is the f that was there, __wrap_f what callers get. The mangled ones
// are operator new(size_t), operator new[](size_t) and operator new(size_t, std::align_val_t).
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" {
void* __real_malloc(std::size_t size);
void* __real_realloc(void* block, std::size_t size);
void* __real__Znwm(std::size_t size);
void* __real__Znam(std::size_t size);
void* __real__ZnwmSt11align_val_t(std::size_t size, std::size_t alignment);

void* __wrap_malloc(std::size_t size) {
  ++count;
  return __real_malloc(size);
}
void* __wrap_realloc(void* block, std::size_t size) {
  ++count;
  return __real_realloc(block, size);
}
void* __wrap__Znwm(std::size_t size) {
  ++count;
  return __real__Znwm(size);
}
void* __wrap__Znam(std::size_t size) {
  ++count;
  return __real__Znam(size);
}
void* __wrap__ZnwmSt11align_val_t(std::size_t size, std::size_t alignment) {
  ++count;
  return __real__ZnwmSt11align_val_t(size, alignment);
}
}
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
