// Long runs that are stopped at any moment, by kill -9 or Ctrl-C: what they had finished is kept, and the
// same command with --resume ends with the same bytes as one that was left alone, but for what a clock says,
// on another number of threads too.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include "experiments/runs/journal.h"
#include "experiments/runs/recorder.h"
#include "solvers/io/input_error.h"
#include "tests/places.h"
#include "tests/results.h"
#include "tests/scratch.h"

BOOST_FIXTURE_TEST_SUITE(resume, springstab::test::ScratchFolder)

namespace fs = std::filesystem;
using namespace springstab;
using springstab::test::content_of;
using springstab::test::files_in;
using springstab::test::untimed;

namespace {

void write(const fs::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

using Arguments = std::vector<std::string>;

// The command as a process of its own, without a shell in between.
class Command {
 public:
  Command(const fs::path& folder, const Arguments& arguments)
      : out_(folder / "stdout"), err_(folder / "stderr") {
    std::vector<char*> words{const_cast<char*>("springstab")};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    process_ = fork();
    BOOST_REQUIRE(process_ >= 0);
    if (process_ > 0) return;
    const auto redirect = [](const fs::path& path, int to) {
      dup2(open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), to);
    };
    redirect(out_, STDOUT_FILENO);
    redirect(err_, STDERR_FILENO);
    if (chdir(folder.c_str()) == 0) execv(springstab::test::command_path().c_str(), words.data());
    _exit(127);
  }

  void send(int signal) const { kill(process_, signal); }

  // The exit status, or minus the signal that ended it.
  int wait() const {
    int status = 0;
    BOOST_REQUIRE(waitpid(process_, &status, 0) == process_);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  std::string out() const { return content_of(out_); }
  std::string err() const { return content_of(err_); }

 private:
  fs::path out_, err_;
  pid_t process_;
};

// What the same command gives when nothing stops it, and how long it takes.
struct Undisturbed {
  Json report;
  std::map<std::string, std::string> files;
  double seconds;

  Undisturbed(const fs::path& folder, const Arguments& arguments) {
    fs::create_directories(folder);
    const auto start = std::chrono::steady_clock::now();
    const Command command(folder, arguments);
    const int status = command.wait();
    BOOST_TEST_CONTEXT(command.err()) { BOOST_REQUIRE_EQUAL(status, 0); }
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report = Json::parse(command.out());
    files = files_in(folder / "out");
  }
};

// Kills and resumes until there have been `kills`, then lets it end. `same` is called with each report.
template <class Same>
void kill_and_resume(const fs::path& folder, Arguments arguments, const Undisturbed& undisturbed, int kills,
                     std::uint64_t seed, bool files_may_differ, Same same) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> delay(0, 2 * undisturbed.seconds / kills);
  const auto run_once = [&](double seconds) {
    fs::create_directories(folder);
    const Command command(folder, arguments);
    if (std::isfinite(seconds)) {
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
      command.send(SIGKILL);
    }
    const int status = command.wait();
    const std::string err = command.err();
    BOOST_TEST_CONTEXT(err) { BOOST_REQUIRE((status == 0 || status == -SIGKILL)); }
    if (!files_may_differ)  // whatever is there is whole
      for (const auto& [name, content] : files_in(folder / "out")) BOOST_TEST_CONTEXT(name) {
          BOOST_REQUIRE((content == undisturbed.files.at(name)));
        }
    if (status != 0) return std::pair(false, err);
    same(Json::parse(command.out()));
    if (!files_may_differ) BOOST_TEST((files_in(folder / "out") == undisturbed.files));
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / "out")) {
      const std::string name = entry.path().filename();
      BOOST_TEST_CONTEXT(name) {
        BOOST_TEST((name.find(".part") == std::string::npos && name.find(".journal") == std::string::npos &&
                    name.find(".checkpoint") == std::string::npos &&
                    name.find(".kept") == std::string::npos));
      }
    }
    return std::pair(true, err);
  };
  int killed = 0, resumed = 0;
  // --resume also of the first: there is nothing yet, and it begins
  arguments.insert(arguments.end(), {"--resume", "--threads", "3"});
  while (killed < kills) {
    const auto [finished, err] = run_once(delay(random));
    resumed += err.find("going on") != std::string::npos;
    killed += !finished;
    if (finished) fs::remove_all(folder);
  }
  BOOST_TEST(run_once(std::numeric_limits<double>::infinity()).first);
  BOOST_TEST(resumed >= kills / 3);
  BOOST_TEST_MESSAGE(arguments[0] << ": " << killed << " kills, resumed " << resumed << " times");
}

const Arguments divergence{"divergence", "--quick", "--cells",  "40", "--steps",
                           "200",        "--json",  "--output", "out"};
const Arguments complexity{"complexity", "--quick", "--json", "--output", "out"};
const Arguments work_precision{
    "work-precision", "--grid", "3x3",           "--pin", "first-row", "--duration", "0.02",
    "--time-limit",   "0.02",   "--repetitions", "2",     "--json",    "--output",   "out"};

// A journal of one's own, with numbers that no decimal fraction of few digits is.
const Json identity{{"command", "count"}, {"options", {{"until", 3}, {"half", 0.5}}}};
Json counted(Journal& journal, int& computed, int until = 3) {
  Json all = Json::array();
  for (int i = 1; i <= until; ++i)
    all.push_back(journal.piece("number " + std::to_string(i), [&] {
      ++computed;
      return Json{{"third", i / 3.}, {"tiny", i * 5e-324}, {"none", nullptr}};
    }));
  return all;
}

const Arguments endless{"--duration", "1e6",      "--method", "symplectic-euler", "--step", "1e-4",
                        "--json",     "--output", "out"};

// Runs until there is a checkpoint, and kills.
void kill_at_checkpoint(const fs::path& folder, const Arguments& arguments) {
  const Command command(folder, arguments);
  const fs::path checkpoint = folder / "out" / "simulate.checkpoint";
  for (int i = 0; i < 5000 && !fs::exists(checkpoint); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  command.send(SIGKILL);
  BOOST_REQUIRE(command.wait() == -SIGKILL);
  BOOST_REQUIRE(fs::exists(checkpoint));
}

std::string refusal(const fs::path& folder, Arguments arguments, bool resume = true) {
  if (resume) arguments.emplace_back("--resume");
  const Command command(folder, arguments);
  BOOST_TEST(command.wait() == 2);
  BOOST_TEST(command.out().empty());
  return command.err();
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_killed_divergence_study_ends_as_if_it_had_not_been) {
  const Undisturbed undisturbed(path() / "left alone", divergence);
  kill_and_resume(path() / "killed", divergence, undisturbed, 12, 1, false,
                  [&](const Json& report) { BOOST_TEST((report == undisturbed.report)); });
}

BOOST_AUTO_TEST_CASE(a_killed_complexity_study_ends_as_if_it_had_not_been) {
  const Undisturbed undisturbed(path() / "left alone", complexity);
  const Json expected = untimed(undisturbed.report);
  BOOST_TEST(expected.at("studies").size() == 4);
  kill_and_resume(path() / "killed", complexity, undisturbed, 12, 2, false,
                  [&](const Json& report) { BOOST_TEST((untimed(report) == expected)); });
}

// A net that gets too stiff for its first step, so that divergences are undone and steps chosen anew;
// implicit Euler, whose steps are halved; and matrices, whose rows go on in their file.
BOOST_AUTO_TEST_CASE(a_killed_simulation_ends_as_if_it_had_not_been) {
  write(path() / "stretched.json",
        R"({"geometry": {"grid": [20, 20]}, "pins": "first-row", "damping": {"d0": 1, "alpha": "designed"},
            "initial": {"stretch": [3, 1, 3]}})");
  write(path() / "slack.json", R"({"geometry": {"grid": [20, 20]}, "pins": "first-row",
            "damping": {"d0": 1, "alpha": 0.001}, "initial": {"stretch": [0.97, 1, 0.97]}})");
  std::string matrix = "%%MatrixMarket matrix coordinate real symmetric\n200 200 399\n";
  for (int i = 1; i <= 200; ++i)
    matrix += std::to_string(i) + ' ' + std::to_string(i) + " 2e4\n" +
              (i < 200 ? std::to_string(i + 1) + ' ' + std::to_string(i) + " -1e4\n" : "");
  write(path() / "chain.mtx", matrix);
  const std::string stretched = path() / "stretched.json", slack = path() / "slack.json",
                    chain = path() / "chain.mtx";
  const std::vector<Arguments> runs{
      {"simulate", stretched, "--method", "linearized-explicit-euler", "--duration", "10"},
      {"simulate", slack, "--method", "implicit-euler", "--step", "0.005", "--duration", "20"},
      {"simulate", slack, "--method", "bdf2", "--step", "0.005", "--duration", "20"},
      {"simulate", "--stiffness", chain, "--method", "rk4", "--duration", "2500", "--frames", "500"}};
  long halved = 0;
  long undone = 0;
  for (Arguments arguments : runs) {
    arguments.insert(arguments.end(), {"--json", "--output", "out"});
    const Undisturbed undisturbed(path() / "left alone", arguments);
    const Json expected = untimed(undisturbed.report);
    BOOST_TEST(expected.at("status") == "done");
    const bool scene = undisturbed.files.contains("energy.csv");  // beside the frames
    BOOST_TEST((scene ? undisturbed.files.size() == 102u : undisturbed.files.contains("trajectory.csv")));
    undone += expected.at("counts").at("rollbacks").get<long>();
    halved += expected.at("counts").at("halved_steps").get<long>();
    BOOST_TEST_MESSAGE(expected.at("method")
                       << ": " << undisturbed.seconds << " s, counts " << expected.at("counts"));
    kill_and_resume(path() / "killed", arguments, undisturbed, 6, 4, false,
                    [&](const Json& report) { BOOST_TEST((untimed(report) == expected)); });
    for (const char* folder : {"left alone", "killed"}) fs::remove_all(path() / folder);
  }
  BOOST_TEST(undone > 0);
  BOOST_TEST(halved > 0);
}

BOOST_AUTO_TEST_CASE(an_interrupted_simulation_goes_on_from_its_own_whole_checkpoint_only) {
  const Arguments run{"simulate",         "--grid",     "20x20", "--pin",  "first-row", "--method",
                      "symplectic-euler", "--duration", "20",    "--json", "--output",  "out"};
  const fs::path checkpoint = path() / "out" / "simulate.checkpoint";
  {
    const Command command(path(), run);
    for (int i = 0; i < 5000 && !fs::exists(checkpoint); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    command.send(SIGINT);
    BOOST_TEST(command.wait() == 130);
    const Json report = Json::parse(command.out());
    BOOST_TEST(report.at("status") == "interrupted");
    BOOST_TEST(report.at("steps").get<long>() > 0);
    const std::string err = command.err();
    BOOST_TEST(err.find(" frames and the run up to t = ") != std::string::npos);
    BOOST_TEST(err.find("--resume") != std::string::npos);
  }
  const std::string whole = content_of(checkpoint);
  const auto refused = [&](const std::string& option, const std::string& value, const std::string& reason) {
    Arguments again = run;
    again.insert(again.end(), {"--resume", option, value});
    const Command command(path(), again);
    BOOST_TEST_CONTEXT(reason) {
      BOOST_TEST(command.wait() == 2);
      BOOST_TEST(command.out().empty());
      BOOST_TEST(command.err().find("simulate.checkpoint: ") != std::string::npos);
      BOOST_TEST(command.err().find(reason) != std::string::npos);
    }
  };
  refused("--frames", "99", "expected the same options/frames");
  refused("--spacing", "0.03", "expected the same inputs/spacing");
  for (const std::size_t place : {std::size_t{20}, whole.size() / 2, whole.size() - 3}) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 1);
    write(checkpoint, damaged);
    refused("--frames", "100", "is damaged");
  }
  for (const std::size_t length : {std::size_t{1}, whole.size() / 2, whole.size() - 1}) {
    write(checkpoint, whole.substr(0, length));
    refused("--frames", "100", "is damaged");
  }
}

BOOST_AUTO_TEST_CASE(another_mesh_behind_the_same_scene_is_refused) {
  write(path() / "mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
  write(path() / "scene.JSON", R"({"geometry": {"mesh": "mesh.obj"}, "pins": [0]})");
  Arguments run{"simulate", "scene.JSON"};
  run.insert(run.end(), endless.begin(), endless.end());
  kill_at_checkpoint(path(), run);
  write(path() / "mesh.obj", "v 0 0 0\nv 2 0 0\nv 0 0 1\nf 1 2 3\n");
  BOOST_TEST(refusal(path(), run).find("expected the same inputs/file/mesh/hash") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(a_pipe_is_not_resumed) {
  BOOST_REQUIRE(mkfifo((path() / "pipe").c_str(), 0600) == 0);
  const auto feed = [&] {
    return std::thread([this] { write(path() / "pipe", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n"); });
  };
  Arguments run{"simulate", "pipe", "--pin", "0"};
  run.insert(run.end(), endless.begin(), endless.end());
  std::thread first = feed();
  kill_at_checkpoint(path(), run);
  first.join();
  std::thread second = feed();
  BOOST_TEST(refusal(path(), run).find("pipe: is no regular file") != std::string::npos);
  second.join();
}

BOOST_AUTO_TEST_CASE(two_runs_do_not_share_an_output) {
  Arguments run{"simulate", "--grid", "3x3", "--pin", "0"};
  run.insert(run.end(), endless.begin(), endless.end());
  const Command first(path(), run);
  for (int i = 0; i < 5000 && !fs::exists(path() / "out" / "simulate.checkpoint"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const fs::path elsewhere = path() / "elsewhere";  // for what the second one says
  fs::create_directories(elsewhere);
  for (Arguments second : {run, divergence, complexity}) {
    *std::find(second.begin(), second.end(), "out") = "../out";
    BOOST_TEST(refusal(elsewhere, second, false).find("../out: is in use") != std::string::npos);
  }
  first.send(SIGKILL);
  first.wait();
  BOOST_TEST(fs::exists(path() / "out" / "simulate.checkpoint"));
}

BOOST_AUTO_TEST_CASE(what_is_missing_in_the_folder_is_named) {
  Arguments run{"simulate", "--grid", "3x3", "--pin", "0"};
  run.insert(run.end(), endless.begin(), endless.end());
  kill_at_checkpoint(path(), run);
  fs::remove(path() / "out" / "frame_00000.obj");
  BOOST_TEST(refusal(path(), run).find("out/frame_00000.obj: is missing") != std::string::npos);
  fs::remove(path() / "out" / "simulate.checkpoint");
  fs::create_directories(path() / "out" / "simulate.checkpoint");
  BOOST_TEST(refusal(path(), run).find("simulate.checkpoint: is a folder") != std::string::npos);
}

// How far a contestant gets is for the clock to say; as far as two runs both get, they agree.
BOOST_AUTO_TEST_CASE(a_killed_contest_ends_as_if_it_had_not_been) {
  const Undisturbed undisturbed(path() / "left alone", work_precision);
  const auto finished_runs = [](const Json& contestant) {
    Json runs = Json::array();
    for (const Json& run : contestant.at("runs"))
      if (run.at("outcome") == "finished") runs.push_back(untimed(run));
    return runs;
  };
  kill_and_resume(path() / "killed", work_precision, undisturbed, 8, 3, true, [&](const Json& report) {
    const Json &left_alone = undisturbed.report.at("contestants"), &resumed = report.at("contestants");
    BOOST_TEST((report.at("reference") == undisturbed.report.at("reference")));
    BOOST_REQUIRE_EQUAL(resumed.size(), left_alone.size());
    std::size_t compared = 0;
    for (std::size_t i = 0; i < resumed.size(); ++i) {
      BOOST_TEST((resumed[i].at("name") == left_alone[i].at("name")));
      const Json a = finished_runs(left_alone[i]), b = finished_runs(resumed[i]);
      for (std::size_t j = 0; j < std::min(a.size(), b.size()); ++j, ++compared) BOOST_TEST((a[j] == b[j]));
    }
    BOOST_TEST(compared > 50);
  });
}

// What was kept is what is reported, its times included.
BOOST_AUTO_TEST_CASE(ctrl_c_says_what_was_saved) {
  for (const Arguments& arguments : {divergence, complexity, work_precision})
    BOOST_TEST_CONTEXT(arguments[0]) {
      const fs::path journal = path() / "out" / (arguments[0] + ".journal");
      const auto pieces = [&] {
        const std::string lines = content_of(journal);
        return std::count(lines.begin(), lines.end(), '\n') - 1;
      };
      const Command command(path(), arguments);
      for (int i = 0; i < 10000 && pieces() < 3; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      command.send(SIGINT);
      BOOST_TEST(command.wait() == 130);
      BOOST_TEST(pieces() >= 3);
      const std::string err = command.err();
      BOOST_TEST(err.find("interrupted; ") != std::string::npos);
      BOOST_TEST(err.find(" finished pieces are saved in out/" + arguments[0] + ".journal") !=
                 std::string::npos);
      BOOST_TEST(command.out().empty());

      Arguments other = arguments;
      other.insert(other.end(), {"--resume", "--seed", "2"});
      const Command refused(path(), other);
      BOOST_TEST(refused.wait() == 2);
      BOOST_TEST(refused.err().find("expected the same options/seed") != std::string::npos);
      BOOST_TEST(pieces() >= 3);
    }
  const Command nowhere(path(), {"complexity", "--quick"});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  nowhere.send(SIGINT);
  BOOST_TEST(nowhere.wait() == 130);
  BOOST_TEST(nowhere.err().find("nothing was saved") != std::string::npos);
  const Command homeless(path(), {"complexity", "--resume"});
  BOOST_TEST(homeless.wait() == 2);
  BOOST_TEST(homeless.err().find("--output") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(a_journal_computes_what_it_lacks_and_nothing_else) {
  int computed = 0;
  const Json all = counted(Journal::none(), computed);
  BOOST_TEST(computed == 3);
  const fs::path file = path() / "count.journal";
  {
    Journal journal(path(), identity, {}, true);
    counted(journal, computed, 2);
    BOOST_CHECK_THROW(Journal(path(), identity, {.resume = true}, true), InputError);  // in use
  }
  const std::string two = content_of(file);
  // The third line whole, torn anywhere, or absent.
  computed = 0;
  {
    Journal journal(path(), identity, {.resume = true}, true);
    BOOST_TEST((journal.has_next(2) && !journal.has_next(3)));
    BOOST_TEST((counted(journal, computed) == all));
  }
  BOOST_TEST(computed == 1);
  const std::string three = content_of(file);
  BOOST_TEST(three.starts_with(two));
  for (std::size_t length = two.size(); length < three.size(); ++length) {
    write(file, three.substr(0, length));
    computed = 0;
    Journal journal(path(), identity, {.resume = true}, true);
    BOOST_TEST((counted(journal, computed) == all));
    BOOST_TEST(computed == 1);
    BOOST_TEST((content_of(file) == three));
  }
  Journal journal(path(), identity, {.resume = true}, true);
  BOOST_TEST(journal.has_next(3));
  journal.finish();
  BOOST_TEST(!fs::exists(file));
}

// A run of matrices that diverges 5 steps after it was left and gone on with.
BOOST_AUTO_TEST_CASE(the_last_steps_before_a_divergence_are_the_same_after_an_interruption) {
  write(path() / "k.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 100\n2 2 50\n");
  const auto rows = [&](bool interrupted) {
    SimulateOptions options;
    options.input.stiffness = path() / "k.mtx";
    options.duration = 100;
    options.frames = 4;
    options.keep_diverged = true;
    options.output = path() / (interrupted ? "left" : "whole");
    make_folder(options.output);
    Subject subject(options.input);
    std::optional<Recorder> recorder(std::in_place, subject, options, Json());
    for (int step = 0; step < 60; ++step) {
      State<Vector> state;
      state.x = Eigen::Vector2d(1. / (1 + step), 2 + step);
      state.v = Eigen::Vector2d(0.5, -step);
      recorder->record(step, state);
      if (!interrupted || step != 54) continue;
      const Json kept = Json::parse(recorder->kept().dump());
      recorder.reset();
      recorder.emplace(subject, options, kept);
    }
    recorder->record_last();
    BOOST_TEST(recorder->last_steps() == 32);
    recorder->finish();
    return content_of(fs::path(options.output) / "trajectory.csv");
  };
  const std::string whole = rows(false);
  BOOST_TEST(std::count(whole.begin(), whole.end(), '\n') == 1 + 2 + 32);  // at 0 and 25; 28 to 59
  std::vector<double> times;
  std::istringstream in(whole.substr(whole.find('\n') + 1));
  for (std::string row; std::getline(in, row);) times.push_back(std::stod(row));
  BOOST_TEST((times[0] == 0 && times[1] == 25));
  for (std::size_t i = 2; i < times.size(); ++i) BOOST_TEST(times[i] == 26. + static_cast<double>(i));
  BOOST_TEST((whole == rows(true)));
}

BOOST_AUTO_TEST_CASE(what_a_killed_process_left_aside_is_removed_and_nothing_else) {
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  BOOST_REQUIRE(waitpid(gone, nullptr, 0) == gone);
  const std::string abandoned = "a.csv.part" + std::to_string(gone);
  const std::set<std::string> others{"a.csv", "b.part", "a.csv.part" + std::to_string(getpid()),
                                     abandoned + "x"};
  for (const std::string& name : others) write(path() / name, "1");
  write(path() / abandoned, "1");
  make_folder(path());
  std::set<std::string> left;
  for (const fs::directory_entry& entry : fs::directory_iterator(path()))
    left.insert(entry.path().filename());
  BOOST_TEST((left == others));
}

BOOST_AUTO_TEST_CASE(a_journal_of_another_run_or_a_damaged_one_is_refused) {
  const fs::path file = path() / "count.journal";
  int computed = 0;
  {
    Journal journal(path(), identity, {}, true);
    counted(journal, computed);
    BOOST_CHECK_THROW(journal.piece("not a number",
                                    [] {
                                      return Json{{"x", std::nan("")}};
                                    }),
                      std::logic_error);
  }
  const std::string whole = content_of(file);
  BOOST_TEST(whole.find("null,") == std::string::npos);  // NaN would be one
  const auto refused = [&](const Json& who, const std::string& reason) {
    try {
      const Journal journal(path(), who, {.resume = true}, true);
    } catch (const InputError& error) {
      const std::string message = error.what();
      BOOST_TEST_CONTEXT(message) {
        BOOST_TEST(message.starts_with(file.string() + ':'));
        BOOST_TEST(message.find(reason) != std::string::npos);
      }
      return;
    }
    BOOST_ERROR("not refused: " + reason);
  };
  Json other = identity;
  other["options"]["until"] = 4;
  refused(other, "options/until");
  BOOST_TEST((content_of(file) == whole));
  for (const std::size_t place : {std::size_t{3}, whole.size() / 3, whole.size() / 2, whole.size() - 3}) {
    std::string damaged = whole;
    damaged[place] = damaged[place] == '1' ? '2' : '1';
    write(file, damaged);
    refused(identity, "is damaged");
  }
  for (const bool resumed : {false, true}) {  // a scene's name in another encoding
    Journal journal(path(), identity, {resumed, !resumed}, true);
    BOOST_TEST(journal.has_next(1) == resumed);
    BOOST_TEST((journal.piece("caf\xe9, rk4", [] { return Json(1); }) == 1));
  }
  write(file, whole);
  Journal journal(path(), identity, {.resume = true}, true);
  BOOST_CHECK_THROW(journal.piece("number 2", [] { return Json(); }), InputError);  // the first one is next
}

BOOST_AUTO_TEST_SUITE_END()
