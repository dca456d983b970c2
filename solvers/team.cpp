#include "solvers/team.h"

#include <atomic>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace springstab {
namespace {

constexpr int patience = 2000;  // looks at a number before a thread falls asleep: some 50 µs

void pause_a_little() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

void wait_while(const std::atomic<unsigned>& number, unsigned value) {
  for (int i = 0; i < patience; ++i) {
    if (number.load(std::memory_order_acquire) != value) return;
    pause_a_little();
  }
  number.wait(value, std::memory_order_acquire);
}

/// The threads beside those that come to a loop. A loop is handed to all of them at once: each takes the
/// parts that are its own, if any.
class Team {
 public:
  ~Team() { dismiss(); }

  int threads() const { return threads_.load(std::memory_order_relaxed); }

  void set_threads(int count) {
    if (count == threads()) return;
    dismiss();
    threads_ = count;
  }

  void share(int parts, void (*call)(const void*, int), const void* work) {
    if (busy_.test_and_set(std::memory_order_acquire)) {
      for (int part = 0; part < parts; ++part) call(work, part);
      return;
    }
    call_members();
    parts_ = parts, call_ = call, work_ = work;
    left_.store(static_cast<unsigned>(members_.size()), std::memory_order_relaxed);
    loop_.fetch_add(1, std::memory_order_release);
    loop_.notify_all();
    take_parts(0);
    for (unsigned left = left_.load(std::memory_order_acquire); left > 0;
         left = left_.load(std::memory_order_acquire))
      wait_while(left_, left);
    busy_.clear(std::memory_order_release);
  }

 private:
  // As many as the system lets us have.
  void call_members() try {
    for (int t = static_cast<int>(members_.size()) + 1; t < threads(); ++t)
      members_.emplace_back([this, t, seen = loop_.load()] { serve(t, seen); });
  } catch (const std::system_error&) {
    threads_ = static_cast<int>(members_.size()) + 1;
  }

  void take_parts(int thread) const {
    for (int part = thread; part < parts_; part += threads()) call_(work_, part);
  }

  void serve(int thread, unsigned seen) {
    for (;; ++seen) {
      wait_while(loop_, seen);
      if (dismissed_) return;
      take_parts(thread);
      if (left_.fetch_sub(1, std::memory_order_acq_rel) == 1) left_.notify_one();
    }
  }

  void dismiss() {
    dismissed_ = true;
    loop_.fetch_add(1, std::memory_order_release);
    loop_.notify_all();
    members_.clear();
    dismissed_ = false;
  }

  std::atomic<int> threads_{1};
  std::atomic_flag busy_;
  std::atomic<unsigned> loop_{0}, left_{0};  // the number of the loop; who has not finished it
  std::atomic<bool> dismissed_{false};
  int parts_ = 0;
  void (*call_)(const void*, int) = nullptr;
  const void* work_ = nullptr;
  std::vector<std::jthread> members_;
};

Team& team() {
  static Team all;
  return all;
}

}  // namespace

void set_loop_threads(int count) {
  if (count < 1)
    throw std::invalid_argument(std::to_string(count) + " threads are to share loops, expected at least 1");
  team().set_threads(count);
}

int loop_threads() { return team().threads(); }

void share_among_threads(int parts, void (*call)(const void*, int), const void* work) {
  team().share(parts, call, work);
}

}  // namespace springstab
