// Where tests write: in the temporary folder, each under a name of its own, so that tests may run side by
// side and nothing is left.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace springstab::test {

inline std::string content_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// An empty folder, removed at the end with what is in it. There are spaces in its name, as users have them.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "springstab test XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("cannot make the folder " + name);
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Writes a file of this name and content; its path.
  std::filesystem::path file(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// One file with this content, removed at the end. What reads it may look at how its name ends.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& content, const std::string& name = "file")
      : path_(folder_.file(name, content)) {}

  std::string name() const { return path_.string(); }

 private:
  ScratchFolder folder_;
  std::filesystem::path path_;
};

}  // namespace springstab::test
