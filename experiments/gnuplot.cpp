#include "experiments/gnuplot.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

void run_gnuplot(const std::string& settings, const std::string& script) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::string("cannot start gnuplot: ") + std::strerror(errno));
  if (child == 0) {
    dup2(STDERR_FILENO, STDOUT_FILENO);  // stdout belongs to the report
    execlp("gnuplot", "gnuplot", "-e", settings.c_str(), script.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
      throw InputError("gnuplot", 0, "was not found, expected it to be installed (gnuplot-nox)");
    throw std::runtime_error("gnuplot failed on " + script);
  }
}

}  // namespace

std::string gnuplot_literal(const std::string& s) {
  std::string quoted = "'";
  for (char c : s) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

std::vector<std::string> draw(const std::string& script, const std::string& settings,
                              const std::string& base) {
  std::vector<std::string> files;
  for (const char* type : {"svg", "png"}) {
    const std::string aside = base + ".part." + type, target = base + "." + type;
    run_gnuplot(settings + "type=" + gnuplot_literal(type) + "; output_file=" + gnuplot_literal(aside),
                script);
    std::filesystem::rename(aside, target);
    files.push_back(target);
  }
  return files;
}

}  // namespace springstab
