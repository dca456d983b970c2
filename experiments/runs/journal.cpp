#include "experiments/runs/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <iostream>
#include <stdexcept>

#include "experiments/command/interrupt.h"
#include "experiments/runs/fnv1a.h"
#include "experiments/runs/identity.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

InputError failure(const std::string& path) {
  return InputError(path, 0, std::string("cannot be written: ") + std::strerror(errno));
}

Json parsed(std::string_view line, const std::string& path, long number) {
  constexpr std::size_t digits = 16;
  if (line.size() > digits && line[digits] == ' ') {
    const std::string_view content = line.substr(digits + 1);
    if (hash_of(content) == line.substr(0, digits)) return Json::parse(content);
  }
  throw InputError(path, number,
                   "is damaged, expected a finished piece; with --overwrite the run starts anew");
}

}  // namespace

Journal& Journal::none() {
  static Journal instance;
  return instance;
}

Journal::Journal(const std::string& folder, const Json& identity, const EarlierRun& earlier, bool quiet) {
  if (folder.empty()) {
    if (earlier.resume) throw InputError("--resume", 0, needs_output);
    exit_on_interrupt("nothing was saved (with --output it would have been)");
    return;
  }
  lock_.emplace(folder);
  path_ = folder + '/' + identity.at("command").get<std::string>() + ".journal";
  expect_decided(path_, earlier);
  file_.descriptor = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_.descriptor < 0) throw failure(path_);
  if (earlier.resume) read(identity);
  if (kept_.empty()) {
    if (ftruncate(file_.descriptor, 0) != 0) throw failure(path_);
    append(identity);
    sync_folder(folder);
    if (earlier.resume && !quiet)
      std::cerr << "springstab: nothing was kept in " << path_ << ", starting anew\n";
  } else {
    kept_.erase(kept_.begin());
    if (!quiet)
      std::cerr << text("springstab: going on after the %zu pieces in %s\n", kept_.size(), path_.c_str());
  }
  tell_interrupt();
}

Journal::File::~File() {
  if (descriptor >= 0) close(descriptor);
}

// Leaves the file at the end of its last whole line.
void Journal::read(const Json& identity) {
  const std::string all = bytes_of(path_);
  std::size_t begin = 0;
  for (std::size_t end; (end = all.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const long line = static_cast<long>(kept_.size()) + 1;
    kept_.push_back(parsed(std::string_view(all).substr(begin, end - begin), path_, line));
    if (line == 1) expect_same_run(kept_[0], identity, path_, line);
  }
  if (ftruncate(file_.descriptor, static_cast<off_t>(begin)) != 0 || lseek(file_.descriptor, 0, SEEK_END) < 0)
    throw failure(path_);
}

void Journal::append(const Json& json) {
  if (!all_finite(json)) throw std::logic_error("a number in a piece is not finite");
  const std::string content = json.dump(), line = hash_of(content) + ' ' + content + '\n';
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t n = ::write(file_.descriptor, line.data() + done, line.size() - done);
    if (n < 0) throw failure(path_);
    done += static_cast<std::size_t>(n);
  }
  if (fsync(file_.descriptor) != 0) throw failure(path_);
}

Json Journal::piece(const std::string& description, const std::function<Json()>& compute) {
  const std::string what = as_utf8(description);
  if (has_next(1)) {
    const Json& piece = kept_[next_++];
    if (piece.at("piece") == what) return piece.at("result");
    throw InputError(path_, static_cast<long>(next_) + 1,
                     "is '" + piece.at("piece").get<std::string>() + "', expected '" + what +
                         "'; with --overwrite the run starts anew");
  }
  Json result = compute();
  if (file_.descriptor < 0) return result;
  kept_.push_back({{"piece", what}, {"result", result}});
  append(kept_.back());
  next_ = kept_.size();
  tell_interrupt();
  return result;
}

void Journal::tell_interrupt() const {
  exit_on_interrupt(text("%zu finished pieces are saved in %s; the same command goes on there with --resume",
                         kept_.size(), path_.c_str()));
}

void Journal::finish() {
  if (file_.descriptor >= 0 && unlink(path_.c_str()) != 0 && errno != ENOENT) throw failure(path_);
}

}  // namespace springstab
