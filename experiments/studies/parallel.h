// Splits a loop over threads; the result does not depend on how many.
#pragma once

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

namespace springstab {

/// Calls body(first, last) on disjoint ranges that cover [0, count), each a multiple of `grain` long but for
/// the last. Rethrows one of the exceptions if any were thrown.
template <class Body>
void parallel_ranges(long count, long grain, int threads, Body body) {
  const long parts = std::clamp<long>(threads, 1, std::max<long>(1, count / grain));
  const long length = (count / parts / grain + 1) * grain;
  std::vector<std::exception_ptr> thrown(parts);
  std::vector<std::thread> workers;
  for (long p = 0; p < parts; ++p)
    workers.emplace_back([&, p] {
      try {
        if (p * length < count) body(p * length, std::min(count, (p + 1) * length));
      } catch (...) {
        thrown[p] = std::current_exception();
      }
    });
  for (std::thread& worker : workers) worker.join();
  for (const std::exception_ptr& exception : thrown)
    if (exception) std::rethrow_exception(exception);
}

}  // namespace springstab
