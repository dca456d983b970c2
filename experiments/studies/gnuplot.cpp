#include "experiments/studies/gnuplot.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

// `start` is called in the child, and is to end in gnuplot.
template <class Start>
void run_gnuplot(const std::string& script, const Start& start) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::string("cannot start gnuplot: ") + std::strerror(errno));
  if (child == 0) {
    start();
    _exit(127);
  }
  int status = 0;
  if (waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
      throw InputError("gnuplot", 0, "was not found, expected it to be installed (gnuplot-nox)");
    throw std::runtime_error("gnuplot failed on " + script);
  }
}

/// gnuplot succeeds on a full disk, too; a figure that was written whole ends as its format does.
bool file_ends_with(const std::string& path, const std::string& ending) {
  std::ifstream file(path, std::ios::binary);
  std::string last(ending.size(), '\0');
  file.seekg(-static_cast<std::streamoff>(ending.size()), std::ios::end);
  return file.read(last.data(), static_cast<std::streamsize>(last.size())) && last == ending;
}

/// Removes a file at the end of the scope; no error if it is not there any more.
struct Removed {
  std::string path;
  ~Removed() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

/// A file without a name, which is gone with this process.
struct Nameless {
  std::FILE* file = std::tmpfile();
  Nameless() {
    if (!file) throw InputError("gnuplot", 0, std::string("no temporary file: ") + std::strerror(errno));
  }
  ~Nameless() { std::fclose(file); }
  Nameless(const Nameless&) = delete;

  std::string content() const {
    std::rewind(file);
    std::string all;
    char buffer[65536];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, file)) all.append(buffer, n);
    return all;
  }
};

}  // namespace

std::string gnuplot_literal(const std::string& s) {
  std::string quoted = "'";
  for (char c : s) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

std::vector<std::string> draw(const std::string& script, const std::string& settings,
                              const std::string& base) {
  std::vector<std::string> files;
  for (const auto& [type, ending] : {std::pair{"svg", "</svg>\n\n"}, {"png", "IEND\xAE\x42\x60\x82"}}) {
    const std::string aside = base + ".part." + type, target = base + "." + type;
    const Removed at_the_end{aside};
    const std::string all =
        settings + "type=" + gnuplot_literal(type) + "; output_file=" + gnuplot_literal(aside);
    run_gnuplot(script, [&] {
      dup2(STDERR_FILENO, STDOUT_FILENO);  // stdout belongs to the report
      execlp("gnuplot", "gnuplot", "-e", all.c_str(), script.c_str(), static_cast<char*>(nullptr));
    });
    if (!file_ends_with(aside, ending))
      throw InputError(target, 0, "cannot be written whole (is the disk full?)");
    std::filesystem::rename(aside, target);
    files.push_back(target);
  }
  return files;
}

std::string drawn(const std::string& lines) {
  const Nameless in, out, said;
  if (std::fwrite(lines.data(), 1, lines.size(), in.file) != lines.size() || std::fflush(in.file) != 0)
    throw InputError("gnuplot", 0, std::string("cannot be told what to draw: ") + std::strerror(errno));
  std::rewind(in.file);
  try {
    run_gnuplot("these lines", [&] {
      dup2(fileno(in.file), STDIN_FILENO);
      dup2(fileno(out.file), STDOUT_FILENO);
      dup2(fileno(said.file), STDERR_FILENO);
      execlp("gnuplot", "gnuplot", static_cast<char*>(nullptr));
    });
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(error.what() + (": " + said.content()));
  }
  return out.content();
}

std::string gnuplot_data(const std::string& name, const std::string& rows) {
  return "$" + name + " << EOD\n" + rows + (rows.ends_with('\n') ? "" : "\n") + "EOD\n";
}

}  // namespace springstab
