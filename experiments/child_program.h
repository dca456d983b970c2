// Another program that answers line by line: it reads requests on its stdin and writes one line for each on
// its stdout. Its stderr is this command's.
#pragma once

#include <sys/types.h>
#include <string>
#include <vector>

namespace springstab {

class ChildProgram {
 public:
  /// Starts it. `timeout` [s] is for each answer. Throws InputError where it cannot be started.
  ChildProgram(std::vector<std::string> command, double timeout);
  /// Closes its stdin and waits for its end; kills it where that does not come within the timeout.
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  /// Sends the line and waits for one. Throws InputError where the program ends, says nothing in time, or
  /// says more than a line may hold.
  std::string ask(const std::string& line);

  /// For messages: the command and which request it is.
  std::string source() const;

 private:
  void send(const std::string& line);
  [[noreturn]] void fail_as_ended();

  std::string name_;
  double timeout_;
  long requests_ = 0;
  pid_t pid_ = -1;
  int to_ = -1, from_ = -1;
  std::string unread_;
};

}  // namespace springstab
