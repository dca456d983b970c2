#include "experiments/report/browser.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "experiments/command/programs.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds patience{120};

/// A folder that is gone in the end.
struct PassingFolder {
  fs::path path;
  PassingFolder() {
    std::string name = (fs::temp_directory_path() / "springstab-XXXXXX").string();
    if (!mkdtemp(name.data())) throw InputError(name, 0, "cannot be made a folder");
    path = name;
  }
  ~PassingFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  PassingFolder(const PassingFolder&) = delete;
};

// In the child. What browsers say of the machine is nobody's business.
[[noreturn]] void become(const std::string& browser, const fs::path& folder) {
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  const std::string profile = "--user-data-dir=" + (folder / "profile").string(),
                    target = "--print-to-pdf=" + (folder / "page.pdf").string(),
                    page = (folder / "page.html").string();
  // As root there is no sandbox.
  execl(browser.c_str(), browser.c_str(), "--headless", "--disable-gpu",
        geteuid() == 0 ? "--no-sandbox" : "--no-first-run", "--no-pdf-header-footer", profile.c_str(),
        target.c_str(), page.c_str(), static_cast<char*>(nullptr));
  _exit(127);
}

bool ends_well(pid_t child, const std::function<bool()>& stop) {
  const auto begin = std::chrono::steady_clock::now();
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() - begin > patience || stop()) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::string printed_as_pdf(const std::string& page, const std::function<bool()>& stop) {
  const auto browser = find_browser();
  if (!browser) throw InputError("--pdf", 0, needs_browser);
  const PassingFolder folder;
  std::ofstream(folder.path / "page.html", std::ios::binary) << page;
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot start " + *browser);
  if (child == 0) become(*browser, folder.path);
  const bool well = ends_well(child, stop);
  if (stop()) return {};
  std::ostringstream pdf;
  pdf << std::ifstream(folder.path / "page.pdf", std::ios::binary).rdbuf();
  if (!well || !pdf.str().starts_with("%PDF-"))
    throw InputError("--pdf", 0, *browser + " did not print the page");
  return pdf.str();
}

}  // namespace springstab
