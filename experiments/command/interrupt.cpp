#include "experiments/command/interrupt.h"

#include <unistd.h>

#include <array>
#include <atomic>

#include "experiments/command/options.h"

namespace springstab {
namespace {

// One is shown while the other is written. A handler may only read what is complete.
std::array<std::string, 2> messages;
std::atomic<const std::string*> shown{&messages[0]};
static_assert(decltype(shown)::is_always_lock_free);
volatile std::sig_atomic_t stop_requested = 0;

void say_and_exit(int) {
  const std::string& message = *shown.load();
  const char* rest = message.data();
  std::size_t left = message.size();
  while (left > 0) {
    const ssize_t n = ::write(STDERR_FILENO, rest, left);
    if (n <= 0) break;
    rest += n;
    left -= static_cast<std::size_t>(n);
  }
  _exit(interrupted);
}

void request_stop(int) { stop_requested = 1; }

struct sigaction action_of(void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  return action;
}

}  // namespace

void exit_on_interrupt(const std::string& saved) {
  std::string& next = shown.load() == &messages[0] ? messages[1] : messages[0];
  next = (isatty(STDERR_FILENO) ? "\n" : "") + ("springstab: interrupted; " + saved + '\n');
  shown = &next;
  const struct sigaction action = action_of(say_and_exit, SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
}

StopOnInterrupt::StopOnInterrupt() {
  stop_requested = 0;
  const struct sigaction action = action_of(request_stop, SA_RESTART | static_cast<int>(SA_RESETHAND));
  sigaction(SIGINT, &action, &before_);
}

StopOnInterrupt::~StopOnInterrupt() { sigaction(SIGINT, &before_, nullptr); }

bool StopOnInterrupt::requested() const { return stop_requested != 0; }

}  // namespace springstab
