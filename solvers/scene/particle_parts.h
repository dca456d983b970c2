// How threads divide what elements, in batches, add to their particles. A part is some free particles in a
// row. Its thread works on every batch that has some of them, in the order of the batches, and adds to these
// particles alone: so nothing is added by two threads, each sum has the order that it has on one thread, and
// what is computed twice is the batches at the parts' edges.
#pragma once

#include <vector>

#include "solvers/team.h"

namespace springstab {

class ParticleParts {
 public:
  /// Calls work(batch, mine) as said. `cost`: of all batches on one thread [ns]; touches(batch, particles):
  /// whether it has some of them. Where it is not worth it all is one part, as where many batches would be
  /// computed twice. Always the same elements.
  template <class Touches, class Work>
  void share(int batches, long particles, double cost, const Touches& touches, const Work& work) {
    set(batches, particles, cost < worth_sharing ? 1 : loop_threads(), touches);
    if (parts_.size() <= 1) {
      for (int batch = 0; batch < batches; ++batch) work(batch, IndexRange{0, particles});
      return;
    }
    springstab::share(static_cast<int>(parts_.size()), [&](int p) {
      for (const int batch : parts_[p].batches) work(batch, parts_[p].mine);
    });
  }

 private:
  struct Part {
    IndexRange mine;
    std::vector<int> batches;
  };

  template <class Touches>
  void set(int batches, long particles, int threads, const Touches& touches) {
    constexpr double most_twice = 0.25;  // of the batches
    if (threads == threads_) return;
    threads_ = threads;
    parts_.clear();
    std::size_t all = 0;
    for (int p = 0; p < threads && threads > 1; ++p) {
      Part& part = parts_.emplace_back(Part{part_of(particles, p, threads), {}});
      for (int batch = 0; batch < batches; ++batch)
        if (touches(batch, part.mine)) part.batches.push_back(batch);
      all += part.batches.size();
    }
    if (static_cast<double>(all) > (1 + most_twice) * batches) parts_.clear();
  }

  int threads_ = 1;
  std::vector<Part> parts_;
};

}  // namespace springstab
