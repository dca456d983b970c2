// How many threads share a loop, within a test.
#pragma once

#include "solvers/team.h"

namespace springstab::test {

/// As many while it lives.
class LoopThreads {
 public:
  explicit LoopThreads(int count) { set_loop_threads(count); }
  ~LoopThreads() { set_loop_threads(1); }
  LoopThreads(const LoopThreads&) = delete;
  LoopThreads& operator=(const LoopThreads&) = delete;
};

}  // namespace springstab::test
