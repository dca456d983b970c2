// How results leave the command: JSON with full precision, tables, files that are never half-written,
// and a progress bar.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

namespace springstab {

using Json = nlohmann::ordered_json;

/// A number for JSON: ∞ becomes "inf", nothing becomes null; NaN throws std::logic_error.
Json number(double value);
Json number(const std::optional<double>& value);

/// Whether every number in it is finite.
bool all_finite(const Json& json);

/// To stdout. Bytes that are not UTF-8, as a file's name may have, become U+FFFD.
void print_json(const Json& document);

/// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...);

/// A file that appears whole or not at all: written beside its place and renamed by commit(). A pipe or a
/// device is written to as it is.
class OutputFile {
 public:
  /// Throws InputError if the file cannot be created.
  explicit OutputFile(const std::string& path);
  /// Goes on after the first `bytes` of what an interrupted run left in kept_path(path). Throws InputError
  /// also where less is there.
  OutputFile(const std::string& path, std::uintmax_t bytes);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  static std::string kept_path(const std::string& path) { return path + ".kept"; }
  static constexpr char not_what_was_kept[] =
      "is not what the run had written; with --overwrite the run starts anew";

  std::ostream& stream() { return stream_; }
  /// Hands everything to the system, to be left there for another run if this one does not commit(). Returns
  /// how many bytes there are, throws InputError if they cannot be written.
  std::uintmax_t keep();
  /// keep(), and waits until the disk has it.
  std::uintmax_t keep_on_disk();
  /// Takes back what was written after the first `bytes`. Throws likewise.
  void cut(std::uintmax_t bytes);
  /// Throws InputError if anything could not be written.
  void commit();
  /// The same, and waits until the disk has the file, and its folder the name.
  void commit_to_disk();

 private:
  std::string path_, target_, aside_;  // as given; what is written in the end; until then
  std::ofstream stream_;
  bool committed_ = false, kept_ = false;
};

/// Waits until the disk has what was written to a file. Throws InputError if it does not take it.
void sync_file(const std::string& path);
/// The same of the names in a folder, where one may look into the folder and its file system can tell.
void sync_folder(const std::string& path);

/// Creates the folder and its parents, on disk too, and removes what killed processes left in it beside its
/// place. Throws InputError if it cannot be made.
void make_folder(const std::string& path);

/// Keeps other processes from writing into the folder, until it is destroyed or the process ends. Throws
/// InputError if another one does.
class FolderLock {
 public:
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

/// For what cannot tell how far it is: on stderr what is done "now", and for how many seconds, once that
/// takes more than one, if stderr is a terminal and not `quiet`.
class Waiting {
 public:
  Waiting(std::string label, bool quiet);
  ~Waiting();  // erases the line
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;
  void now(const std::string& what);

 private:
  void show();

  std::string label_, what_;
  bool ended_ = false;
  std::mutex mutex_;
  std::condition_variable end_;
  std::thread thread_;  // last: it uses the others
};

/// A bar on stderr for what takes more than a second, if stderr is a terminal and not `quiet`.
class Progress {
 public:
  Progress(std::string label, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void update(double fraction);

 private:
  std::string label_;
  bool enabled_, shown_ = false;
  std::optional<double> first_;  // fraction, of what goes on from an earlier run
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace springstab
