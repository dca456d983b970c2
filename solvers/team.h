// Threads that share the loops of a process: over the particles of a force, over the rows of a product. Who
// gets which part of a loop is fixed beforehand, and every sum keeps the order that it has on one thread, so
// that results are the same bits with any number of threads.
//
//     set_loop_threads(2);
//     share_range(n, [&](long first, long last) {
//       for (long i = first; i < last; ++i) y[i] = a * x[i];
//     });
#pragma once

#include <algorithm>

namespace springstab {

/// How many threads share a loop, the one that comes to it among them; 1 unless set, expected at least 1.
/// They are made when first needed. Not while a loop is being shared.
void set_loop_threads(int count);
int loop_threads();

/// From about this much work on [ns of one thread, estimated] a loop is shared.
inline constexpr double worth_sharing = 50'000;

/// work(part) for an opaque `work`; see share.
void share_among_threads(int parts, void (*call)(const void* work, int part), const void* work);

/// Calls work(0), …, work(parts - 1), on as many threads as there are, and returns when all have returned.
/// `work` must not throw. Within `work`, or while another thread shares a loop, one after another.
template <class Work>
void share(int parts, const Work& work) {
  if (parts == 1) {
    work(0);
  } else {
    share_among_threads(
        parts, [](const void* w, int part) { (*static_cast<const Work*>(w))(part); }, &work);
  }
}

/// Numbers [first, last).
struct IndexRange {
  long first, last;
  bool holds(long i) const { return first <= i && i < last; }
};

/// Part number `part` of [0, count): about equal ones, whose ends are multiples of eight.
inline IndexRange part_of(long count, int part, int parts) {
  const auto end = [&](long p) { return p == parts ? count : count * p / parts / 8 * 8; };
  return {end(part), end(part + 1)};
}

/// Calls work(first, last) on ranges that cover [0, count), shared where it is worth it: `cost` is one
/// number's [ns].
template <class Work>
void share_range(long count, double cost, const Work& work) {
  const int parts = static_cast<double>(count) * cost < worth_sharing ? 1 : loop_threads();
  share(parts, [&](int part) {
    const IndexRange range = part_of(count, part, parts);
    work(range.first, range.last);
  });
}

}  // namespace springstab
