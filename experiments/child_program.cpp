#include "experiments/child_program.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "experiments/command/output.h"
#include "solvers/io/input_error.h"

extern char** environ;

namespace springstab {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t longest_line = 1 << 28;

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status)) return text("was ended by signal %d", WTERMSIG(status));
  return text("ended with exit status %d", WEXITSTATUS(status));
}

// Whether something can be done with the descriptor before `end`.
bool ready(int descriptor, short what, Clock::time_point end) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd waited{descriptor, what, 0};
    const int count = poll(&waited, 1, static_cast<int>(std::clamp<long>(left, 0, 1'000'000)));
    if (count > 0) return true;
    if (count == 0 && left <= 0) return false;
    if (count < 0 && errno != EINTR) return false;
  }
}

}  // namespace

ChildProgram::ChildProgram(std::vector<std::string> command, double timeout)
    : name_(command.at(0)), timeout_(timeout) {
  int request[2], answer[2];
  if (pipe2(request, O_CLOEXEC) != 0) throw InputError(name_, 0, std::strerror(errno));
  if (pipe2(answer, O_CLOEXEC) != 0) {
    close(request[0]), close(request[1]);
    throw InputError(name_, 0, std::strerror(errno));
  }
  std::signal(SIGPIPE, SIG_IGN);  // a program that has ended shows as an error of write()
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, request[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, answer[1], STDOUT_FILENO);
  const int error = posix_spawnp(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(request[0]), close(answer[1]);
  to_ = request[1], from_ = answer[0];
  if (error != 0) {
    close(to_), close(from_);
    throw InputError(name_, 0, "cannot be started: " + std::string(std::strerror(error)));
  }
  fcntl(to_, F_SETFL, O_NONBLOCK);
}

ChildProgram::~ChildProgram() {
  close(to_), close(from_);
  if (pid_ < 0) return;
  const auto end = Clock::now() + std::chrono::duration<double>(std::min(timeout_, 2.0));
  while (waitpid(pid_, nullptr, WNOHANG) == 0) {
    if (Clock::now() > end) kill(pid_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

std::string ChildProgram::source() const { return name_ + text(", answer %ld", requests_); }

void ChildProgram::fail_as_ended() {
  int status = 0;
  const auto end = Clock::now() + std::chrono::seconds(1);
  while (waitpid(pid_, &status, WNOHANG) == 0) {
    if (Clock::now() > end) throw InputError(source(), 0, "its stdout is closed, expected a line of JSON");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  pid_ = -1;
  throw InputError(source(), 0, "the program " + how_it_ended(status) + ", expected a line of JSON");
}

void ChildProgram::send(const std::string& line) {
  const auto end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_));
  for (std::size_t sent = 0; sent < line.size();) {
    if (!ready(to_, POLLOUT, end))
      throw InputError(source(), 0, text("the program does not read within %g s", timeout_));
    const ssize_t count = write(to_, line.data() + sent, line.size() - sent);
    if (count < 0 && errno != EAGAIN && errno != EINTR) fail_as_ended();
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
}

std::string ChildProgram::ask(const std::string& line) {
  ++requests_;
  send(line + '\n');
  const auto end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_));
  std::size_t searched = 0, newline;
  while ((newline = unread_.find('\n', searched)) == std::string::npos) {
    searched = unread_.size();
    if (unread_.size() > longest_line)
      throw InputError(source(), 0, "more than 256 MB without an end of line");
    if (!ready(from_, POLLIN, end))
      throw InputError(source(), 0, text("none within %g s (--timeout), expected a line of JSON", timeout_));
    char part[1 << 16];
    const ssize_t count = read(from_, part, sizeof part);
    if (count == 0) fail_as_ended();
    if (count > 0) unread_.append(part, static_cast<std::size_t>(count));
  }
  std::string answer = unread_.substr(0, newline);
  unread_.erase(0, newline + 1);
  return answer;
}

}  // namespace springstab
