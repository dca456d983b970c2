// The command run as people and programs run it: as a process, in a folder of its own.
#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <boost/test/unit_test.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/places.h"
#include "tests/scratch.h"

namespace springstab::test {

struct Outcome {
  int status;
  std::string out, err;

  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// A folder of its own per test case, removed at the end.
class Command {
 public:
  std::filesystem::path file(const std::string& name, const std::string& content) const {
    return folder_.file(name, content);
  }
  const std::filesystem::path& folder() const { return folder_.path(); }

  Outcome operator()(const std::string& arguments) const { return shell("\"$springstab\" " + arguments); }

  /// Any line for the shell, in the folder; its $springstab is the command. stderr is caught too.
  Outcome shell(const std::string& line) const {
    const std::filesystem::path err = folder() / "stderr";
    const std::string whole = "cd '" + folder().string() + "' && springstab='" + command_path() + "' && { " +
                              line + "\n} 2>'" + err.string() + "'";
    FILE* pipe = popen(whole.c_str(), "r");
    BOOST_REQUIRE(pipe);
    Outcome outcome{};
    std::array<char, 4096> buffer;
    while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe))
      outcome.out.append(buffer.data(), n);
    const int status = pclose(pipe);
    BOOST_REQUIRE(WIFEXITED(status));
    outcome.status = WEXITSTATUS(status);
    outcome.err = content_of(err);
    std::filesystem::remove(err);
    return outcome;
  }

 private:
  ScratchFolder folder_;
};

inline long lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

}  // namespace springstab::test
