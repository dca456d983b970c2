// What Ctrl-C does. Exit status 130 in every case.
#pragma once

#include <csignal>
#include <string>

namespace springstab {

/// From now on Ctrl-C says on stderr that the command was interrupted and what was `saved`, and ends the
/// program at once: nothing is unwound, for what is to be kept is in its file by then.
void exit_on_interrupt(const std::string& saved);

/// While one of these lives Ctrl-C raises a flag, for a loop that can stop where its state is whole. A second
/// one ends the program at once.
class StopOnInterrupt {
 public:
  StopOnInterrupt();
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

  bool requested() const;

 private:
  struct sigaction before_;
};

}  // namespace springstab
