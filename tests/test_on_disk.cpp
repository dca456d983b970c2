// What a run keeps counts once the disk has it: seen from its system calls, the content of a file is synced
// before it gets its name, the folder after that, and all that a checkpoint speaks of before the checkpoint.
#include <fcntl.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "tests/command.h"
#include "tests/places.h"

BOOST_FIXTURE_TEST_SUITE(on_disk, springstab::test::Command)

namespace fs = std::filesystem;
using springstab::test::content_of;
using springstab::test::Outcome;

namespace {

// "sync PATH" and "rename TO", by absolute paths.
using Events = std::vector<std::string>;

std::string text_at(pid_t process, std::uint64_t address) {
  std::ifstream memory("/proc/" + std::to_string(process) + "/mem", std::ios::binary);
  memory.seekg(static_cast<std::streamoff>(address));
  std::string text;
  std::getline(memory, text, '\0');
  return text;
}

void add_event(pid_t process, const __ptrace_syscall_info& call, const fs::path& folder, Events& events) {
  const auto nr = static_cast<long>(call.entry.nr);
  const auto target = [&](int argument) {
    return (folder / text_at(process, call.entry.args[argument])).lexically_normal().string();
  };
  if (nr == SYS_fsync || nr == SYS_fdatasync)
    events.push_back("sync " + fs::read_symlink("/proc/" + std::to_string(process) + "/fd/" +
                                                std::to_string(call.entry.args[0]))
                                   .string());
#ifdef SYS_rename
  if (nr == SYS_rename) events.push_back("rename " + target(1));
#endif
  if (nr == SYS_renameat || nr == SYS_renameat2) events.push_back("rename " + target(3));
}

// Runs the command in the folder until `enough` has been seen of it, and kills it.
Events events_of(const fs::path& folder, std::vector<std::string> arguments,
                 const std::function<bool(const Events&)>& enough) {
  arguments.insert(arguments.begin(), "springstab");
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  const pid_t process = fork();
  BOOST_REQUIRE(process >= 0);
  if (process == 0) {
    const int nowhere = open("/dev/null", O_RDWR);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    if (chdir(folder.c_str()) == 0 && ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0)
      execv(springstab::test::command_path().c_str(), words.data());
    _exit(127);
  }
  int status = 0;
  waitpid(process, &status, 0);
  BOOST_REQUIRE_MESSAGE(WIFSTOPPED(status), "processes cannot be traced here");
  ptrace(PTRACE_SETOPTIONS, process, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
  Events events;
  for (std::size_t seen = 0; events.size() == seen || !enough(events);) {
    seen = events.size();
    ptrace(PTRACE_SYSCALL, process, nullptr, nullptr);
    waitpid(process, &status, 0);
    BOOST_REQUIRE_MESSAGE(WIFSTOPPED(status), "ended early, with " << status);
    if (WSTOPSIG(status) != (SIGTRAP | 0x80)) continue;
    __ptrace_syscall_info call{};
    ptrace(PTRACE_GET_SYSCALL_INFO, process, sizeof call, &call);
    if (call.op == PTRACE_SYSCALL_INFO_ENTRY) add_event(process, call, folder, events);
  }
  kill(process, SIGKILL);
  waitpid(process, &status, 0);
  return events;
}

bool is_checkpoint(const std::string& event) {
  return event.starts_with("rename ") && event.ends_with("/simulate.checkpoint");
}

// One event more than the second checkpoint.
bool two_checkpoints(const Events& events) {
  return std::count_if(events.begin(), events.end(), is_checkpoint) == 2 && !is_checkpoint(events.back());
}

// Since `first` something whose path begins so was synced, before `last`.
bool synced(Events::const_iterator first, Events::const_iterator last, const std::string& path) {
  return std::any_of(first, last,
                     [&](const std::string& event) { return event.starts_with("sync " + path); });
}

void expect_checkpoints_on_disk(const Events& events, const fs::path& out, const std::string& also = "") {
  auto last = events.begin();
  for (auto at = events.begin(); at != events.end(); ++at) {
    if (!is_checkpoint(*at)) continue;
    BOOST_TEST(synced(last, at, out / "simulate.checkpoint.part"));
    BOOST_TEST(((at + 1) != events.end() && *(at + 1) == "sync " + out.string()));
    if (!also.empty()) BOOST_TEST(synced(last, at, out / also));
    for (auto file = last; file != at; ++file)
      if (file->starts_with("rename ") && !is_checkpoint(*file))
        BOOST_TEST(synced(file, at, file->substr(7)), *file << " was not synced");
    last = at;
  }
}

const std::vector<std::string> endless{"--duration", "1e6",  "--method", "symplectic-euler",
                                       "--step",     "1e-4", "--output", "out"};

}  // namespace

BOOST_AUTO_TEST_CASE(a_checkpoint_counts_once_it_and_all_that_it_speaks_of_are_on_disk) {
  const fs::path here = fs::canonical(folder()), out = here / "out";
  std::vector<std::string> cloth{"simulate", "--grid", "3x3", "--pin", "0", "--frames", "100000"};
  cloth.insert(cloth.end(), endless.begin(), endless.end());
  const Events events = events_of(here, cloth, two_checkpoints);
  BOOST_TEST(events.front() == "sync " + here.string());  // the new folder's name
  expect_checkpoints_on_disk(events, out);
  BOOST_TEST(std::any_of(events.begin(), events.end(), [](const std::string& event) {
    return event.find("/frame_0000") != std::string::npos && event.starts_with("sync ");
  }));
  fs::remove_all(out);

  file("k.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 100\n2 2 50\n");
  std::vector<std::string> matrices{"simulate", "--stiffness", "k.mtx", "--frames", "100000"};
  matrices.insert(matrices.end(), endless.begin(), endless.end());
  expect_checkpoints_on_disk(events_of(here, matrices, two_checkpoints), out, "trajectory.csv.kept");
}

BOOST_AUTO_TEST_CASE(a_journal_and_its_folder_are_on_disk_before_its_first_piece) {
  const fs::path here = fs::canonical(folder()), out = here / "out";
  const auto enough = [](const Events& all) {
    return std::count_if(all.begin(), all.end(), [](const auto& e) { return e.starts_with("sync "); }) == 6;
  };
  Events syncs = events_of(here, {"divergence", "--quick", "--output", "out"}, enough);
  std::erase_if(syncs, [](const std::string& event) { return !event.starts_with("sync "); });
  const std::string journal = "sync " + (out / "divergence.journal").string();
  const Events expected{"sync " + here.string(), journal, "sync " + out.string(), journal, journal, journal};
  BOOST_TEST(syncs == expected, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(every_byte_of_what_a_run_of_matrices_had_written_is_held_against_its_hash) {
  file("k.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 100\n2 2 50\n");
  const fs::path here = fs::canonical(folder()), kept = here / "out" / "trajectory.csv.kept";
  std::vector<std::string> run{"simulate", "--stiffness", "k.mtx", "--frames", "100000"};
  run.insert(run.end(), endless.begin(), endless.end());
  events_of(here, run, two_checkpoints);
  const std::string whole = content_of(kept);
  std::string line;
  for (const std::string& word : run) line += word + ' ';
  const Outcome asked = (*this)(line);
  BOOST_TEST(asked.status == 2);
  BOOST_TEST(asked.err.find("expected --resume to go on with it or --overwrite") != std::string::npos);
  for (const std::size_t place : {std::size_t{0}, std::size_t{30}, whole.size() / 3}) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 1);
    file("out/trajectory.csv.kept", damaged);
    const Outcome refused = (*this)(line + "--resume");
    BOOST_TEST(refused.status == 2);
    BOOST_TEST(refused.err.find("trajectory.csv.kept: is not what the run had written") != std::string::npos);
  }
}

BOOST_AUTO_TEST_SUITE_END()
