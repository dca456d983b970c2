// Several passes over the rows of a symmetric matrix at once, each some way behind the one before it, so that
// rows are read from memory once for all of them and then from the cache.
//
// Rows go from the last to the first (BlockSparseMatrix::multiply_rows). A pass may come to a row when the
// pass before it has taken all rows that this one couples to and that come later, which reach one bandwidth W
// further. Whatever belongs to one row alone, the vector that is multiplied among it, can then be made anew
// in place: the pass before has no more use for it. Of what a pass adds to rows to come the same holds. So
// passes a bandwidth apart need no memory of their own, and no pass ever adds out of turn.
#pragma once

#include <algorithm>

#include "solvers/team.h"

namespace springstab {

/// Rows go in blocks; a pass is `lag` blocks behind the one before it. That is so far that what passes do to
/// blocks at the same time has nothing in common, and threads may share it.
class Wavefront {
 public:
  Wavefront(long rows, long bandwidth)
      : rows_(rows),
        block_(std::max(loop_threads() > 1 ? least_shared : least_block, (bandwidth / 4 + 8) / 8 * 8)),
        lag_((bandwidth + block_) / block_ + 1) {}

  /// Between the rows that a pass and the next one are at.
  long rows_apart() const { return lag_ * block_; }

  /// Calls work(pass, rows) for each pass and block, those of a pass one after the other, and done(pass) when
  /// a pass has been through all rows.
  template <class Work, class Done>
  void go(long passes, const Work& work, const Done& done) const {
    const long blocks = (rows_ + block_ - 1) / block_;
    for (long tick = 0; tick < blocks + (passes - 1) * lag_; ++tick) {
      const long first = std::max(0L, tick - blocks + lag_) / lag_, last = std::min(passes, tick / lag_ + 1);
      if (first == last) continue;  // one has been through few blocks before the next may begin
      share(static_cast<int>(last - first), [&](int p) {
        const long pass = first + p, begin = (blocks - 1 - (tick - pass * lag_)) * block_;
        work(pass, IndexRange{begin, std::min(begin + block_, rows_)});
      });
      if (tick - first * lag_ == blocks - 1) done(first);
    }
  }

 private:
  static constexpr long least_block = 256;    // rows, so that calls do not count
  static constexpr long least_shared = 1024;  // some 20 µs, so that threads that wait for each other do not

  long rows_, block_, lag_;
};

}  // namespace springstab
