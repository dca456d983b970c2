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
/// parts that are its own, if any; who came to the loop then takes those that nobody has begun, since on a
/// machine that is busy otherwise a thread may have no core to begin on.
class Team {
 public:
  ~Team() { dismiss(); }

  int threads() const { return threads_.load(std::memory_order_relaxed); }

  void set_threads(int count) {
    if (count == threads()) return;
    dismiss();
    threads_ = count;
    begun_ = std::vector<std::atomic<unsigned>>(static_cast<std::size_t>(count));
    for (std::atomic<unsigned>& begun : begun_) begun = loop_.load();
  }

  void share(int parts, void (*call)(const void*, int), const void* work) {
    if (busy_.test_and_set(std::memory_order_acquire)) {
      for (int part = 0; part < parts; ++part) call(work, part);
      return;
    }
    call_members();
    parts_ = parts, call_ = call, work_ = work;
    left_.store(static_cast<unsigned>(threads()), std::memory_order_relaxed);
    const unsigned loop = loop_.fetch_add(1, std::memory_order_release) + 1;
    loop_.notify_all();
    for (int thread = 0; thread < threads(); ++thread) take_parts(thread, loop);
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

  // Unless they are begun, or the loop is over.
  void take_parts(int thread, unsigned loop) {
    unsigned before = loop - 1;
    if (!begun_[thread].compare_exchange_strong(before, loop, std::memory_order_relaxed)) return;
    for (int part = thread; part < parts_; part += threads()) call_(work_, part);
    if (left_.fetch_sub(1, std::memory_order_acq_rel) == 1) left_.notify_one();
  }

  void serve(int thread, unsigned seen) {
    for (;;) {
      wait_while(loop_, seen);
      if (dismissed_) return;
      seen = loop_.load(std::memory_order_acquire);
      take_parts(thread, seen);
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
  std::atomic<unsigned> loop_{0}, left_{0};  // the number of the loop; threads whose parts are not finished
  std::vector<std::atomic<unsigned>> begun_ =
      std::vector<std::atomic<unsigned>>(1);  // of each thread's parts, the last loop that began them
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
