#include "experiments/command/output.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <locale>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr std::string_view part_suffix = ".part";

// Whether an OutputFile of a process that is no more left it.
bool is_abandoned(const std::string& name) {
  const std::size_t part = name.rfind(part_suffix);
  if (part == std::string::npos) return false;
  pid_t process = 0;
  const char *begin = name.data() + part + part_suffix.size(), *end = name.data() + name.size();
  const auto [stopped, error] = std::from_chars(begin, end, process);
  return error == std::errc() && stopped == end && kill(process, 0) != 0 && errno == ESRCH;
}

// With the system's reason, if it is known: a stream that failed before has none.
std::string cannot_be_written() {
  return std::string("cannot be written") +
         (errno ? std::string(": ") + std::strerror(errno) : " (a full disk?)");
}

// Whether fsync() could be called and succeeded; else errno says why not.
bool is_synced(const std::string& path, int flags) {
  const int descriptor = open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool synced = fsync(descriptor) == 0;
  const int reason = errno;
  close(descriptor);
  errno = reason;
  return synced;
}

}  // namespace

Json number(double value) {
  if (std::isnan(value)) throw std::logic_error("a result is not a number");
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json number(const std::optional<double>& value) { return value ? number(*value) : Json(); }

bool all_finite(const Json& json) {
  if (json.is_structured())
    return std::ranges::all_of(json, [](const Json& part) { return all_finite(part); });
  return !json.is_number_float() || std::isfinite(json.get<double>());
}

void print_json(const Json& document) {
  std::cout << document.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

std::string text(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string result(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, arguments)), '\0');
  std::vsnprintf(result.data(), result.size() + 1, format, again);
  va_end(again);
  va_end(arguments);
  return result;
}

OutputFile::OutputFile(const std::string& path) : path_(path), target_(path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_regular_file(status) && fs::is_symlink(path)) target_ = fs::canonical(path).string();
  const bool in_place = fs::exists(status) && !fs::is_regular_file(status);
  aside_ = in_place ? target_ : target_ + std::string(part_suffix) + std::to_string(getpid());
  stream_.open(aside_);
  if (!stream_) throw InputError(path, 0, cannot_be_written());
  stream_.imbue(std::locale::classic());
  stream_.precision(17);
}

OutputFile::OutputFile(const std::string& path, std::uintmax_t bytes)
    : path_(path), target_(path), aside_(kept_path(path)), kept_(bytes > 0) {
  if (bytes > 0) {
    std::error_code error;
    const std::uintmax_t there = std::filesystem::file_size(aside_, error);
    if (!error && there >= bytes) std::filesystem::resize_file(aside_, bytes, error);
    if (error || there < bytes) throw InputError(aside_, 0, not_what_was_kept);
  }
  stream_.open(aside_, bytes > 0 ? std::ios::app : std::ios::trunc);
  if (!stream_) throw InputError(path, 0, cannot_be_written());
  stream_.imbue(std::locale::classic());
  stream_.precision(17);
}

void OutputFile::cut(std::uintmax_t bytes) {
  keep();
  std::error_code error;
  std::filesystem::resize_file(aside_, bytes, error);
  stream_.seekp(static_cast<std::streamoff>(bytes));
  if (error || !stream_) throw InputError(path_, 0, cannot_be_written());
}

std::uintmax_t OutputFile::keep_on_disk() {
  const std::uintmax_t bytes = keep();
  sync_file(aside_);
  return bytes;
}

std::uintmax_t OutputFile::keep() {
  errno = 0;
  stream_.flush();
  if (!stream_) throw InputError(path_, 0, cannot_be_written());
  kept_ = true;
  return std::filesystem::file_size(aside_);
}

OutputFile::~OutputFile() {
  if (committed_ || kept_ || aside_ == target_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(aside_, ignored);
}

void OutputFile::commit() {
  errno = 0;
  stream_.close();
  if (!stream_) throw InputError(path_, 0, cannot_be_written());
  std::error_code error;
  std::filesystem::rename(aside_, target_, error);
  if (error) throw InputError(path_, 0, "cannot be written: " + error.message());
  committed_ = true;
}

void OutputFile::commit_to_disk() {
  stream_.flush();  // what fails here shows in commit()
  sync_file(aside_);
  commit();
  sync_folder(std::filesystem::path(target_).parent_path());
}

void sync_file(const std::string& path) {
  if (!is_synced(path, O_RDONLY)) throw InputError(path, 0, cannot_be_written());
}

void sync_folder(const std::string& path) {
  if (is_synced(path.empty() ? "." : path, O_RDONLY | O_DIRECTORY)) return;
  if (errno == EIO || errno == ENOSPC || errno == EDQUOT) throw InputError(path, 0, cannot_be_written());
}

void make_folder(const std::string& path) {
  std::error_code error;
  std::vector<std::filesystem::path> parents;  // of what is to be made
  for (std::filesystem::path at = std::filesystem::absolute(path).lexically_normal();
       at.has_relative_path() && !std::filesystem::exists(at, error); at = parents.back())
    parents.push_back(at.parent_path());
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path))
    throw InputError(path, 0, "cannot be made a folder" + (error ? ": " + error.message() : std::string()));
  for (const std::filesystem::path& parent : parents) sync_folder(parent);
  for (const auto& entry : std::filesystem::directory_iterator(path, error))
    if (is_abandoned(entry.path().filename().string())) std::filesystem::remove(entry.path(), error);
}

FolderLock::FolderLock(const std::string& folder)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  // Where the file system has no locks, there is none.
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  close(descriptor_);
  throw InputError(folder, 0, "is in use, expected no other run with the same --output");
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

Waiting::Waiting(std::string label, bool quiet) : label_(std::move(label)) {
  if (!quiet && isatty(STDERR_FILENO)) thread_ = std::thread([this] { show(); });
}

Waiting::~Waiting() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  end_.notify_one();
  thread_.join();
}

void Waiting::now(const std::string& what) {
  const std::lock_guard lock(mutex_);
  what_ = what;
}

void Waiting::show() {
  std::unique_lock lock(mutex_);
  for (int seconds = 1; !end_.wait_for(lock, std::chrono::seconds(1), [this] { return ended_; }); ++seconds)
    std::cerr << "\r\033[K" << label_ << ": " << what_ << ", " << seconds << " s" << std::flush;
  std::cerr << "\r\033[K" << std::flush;
}

Progress::Progress(std::string label, bool quiet)
    : label_(std::move(label)),
      enabled_(!quiet && isatty(STDERR_FILENO)),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (shown_) std::cerr << "\r\033[K" << std::flush;
}

namespace {

std::string time_left(double seconds) {
  const long s = std::lround(seconds);
  if (s < 100) return text("%ld s", s);
  if (s < 6000) return text("%ld min", (s + 30) / 60);
  return text("%ld h %02ld min", s / 3600, s % 3600 / 60);
}

}  // namespace

void Progress::update(double fraction) {
  if (!enabled_) return;
  if (!first_) first_ = fraction;
  const auto now = std::chrono::steady_clock::now();
  if (now - start_ < std::chrono::seconds(1) || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  shown_ = true;
  const int filled = static_cast<int>(30 * fraction);
  std::cerr << '\r' << label_ << " [" << std::string(filled, '#') << std::string(30 - filled, ' ') << "] "
            << static_cast<int>(100 * fraction) << " %";
  if (fraction > *first_) {
    const std::chrono::duration<double> elapsed = now - start_;
    std::cerr << ", " << time_left(elapsed.count() * (1 - fraction) / (fraction - *first_)) << " left";
  }
  std::cerr << "\033[K" << std::flush;
}

}  // namespace springstab
