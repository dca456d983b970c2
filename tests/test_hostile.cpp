// What the command meets outside of friendly folders: endless devices, pipes, holes, full disks, other
// languages. A clear line, status 2, bounded memory, and no file that is not whole.
#include <sys/stat.h>

#include <boost/test/unit_test.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/command.h"
#include "tests/results.h"

BOOST_FIXTURE_TEST_SUITE(hostile, springstab::test::Command)

namespace fs = std::filesystem;
using springstab::test::Command;
using springstab::test::lines;
using springstab::test::Outcome;
using springstab::test::without_cheapest;

namespace {

const std::string matrix =
    "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2.5\n2 1 -1.25\n2 2 2\n";
const std::string cloth = "v 0 0 0\nv 1 0 0\nv 1 0 1.5\nv 0 0 1\nf 1 2 3 4\n";

void check_refused(const Outcome& run, const std::string& word) {
  BOOST_TEST_CONTEXT("expected " << word << ", got " << run.err) {
    BOOST_TEST(run.status == 2);
    BOOST_TEST(run.out.empty());
    BOOST_TEST(lines(run.err) == 1);
    BOOST_TEST(run.err.find(word) != std::string::npos);
  }
}

std::vector<std::string> names(const fs::path& folder) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder)) found.push_back(entry.path().filename().string());
  std::sort(found.begin(), found.end());
  return found;
}

#ifdef SPRINGSTAB_INSTRUMENTED
constexpr bool limits_memory = false;
#else
constexpr bool limits_memory = true;
#endif
const std::string in_little_memory = limits_memory ? "ulimit -v 400000; " : "";  // [kB]

}  // namespace

BOOST_AUTO_TEST_CASE(what_is_no_text_is_refused_at_once_and_in_little_memory) {
  const std::string header = matrix.substr(0, matrix.find("1 1"));
  for (const auto& [name, size] : {std::pair{"hole", 1ULL << 31}, {"short hole", (1ULL << 31) - 4096}}) {
    file(std::string(name) + ".mtx", header);
    file(std::string(name) + ".obj", cloth);
    file(std::string(name) + ".json", "{\n");
    for (const char* suffix : {".mtx", ".obj", ".json"})
      fs::resize_file(folder() / (name + std::string(suffix)), size);
  }
  fs::create_directory(folder() / "directory.mtx");
  fs::create_directory(folder() / "directory.json");
  BOOST_REQUIRE_EQUAL(mkfifo((folder() / "fifo.obj").c_str(), 0600), 0);
  file("endless.json", R"({"geometry": {"mesh": "/dev/zero"}})");
  file("wide.mtx", "%%MatrixMarket matrix coordinate real general\n1000000000 1000000000 1\n1 1 1\n");
  file("long.mtx", "%%MatrixMarket matrix coordinate real general\n3 3 1000000000\n1 1 1\n");
  file("array.mtx", "%%MatrixMarket matrix array real general\n1000000000 1000000000\n1\n");
  file("long.rsa",
       "t\n 1000000002 1 1 1000000000\nRSA 1 1 1000000000 0\n(2I9) (1000I10) (1F9.1)\n 1 2\n 1\n 1.0\n");
  file("grid.json", R"({"geometry": {"grid": [1000000000, 1000000000]}})");
  file("pins.json", R"({"geometry": {"grid": [2, 2]}, "pins": "0-19999999,1-19999998"})");
  std::string book = "v 0 0 0\nv 1 0 0\n";  // 30 000 pages at one spine: 1e9 pairs
  for (int i = 0; i < 30000; ++i) book += "v 0 1 " + std::to_string(i) + "\nf 1 2 -1\n";
  file("book.obj", book);
  file("utf16.obj", std::string("v\0 \0", 4));
  const std::pair<std::string, std::string> cases[] = {
      {"'hole.obj'", "hole.obj: has more than 2^31 - 1 bytes"},
      {"hole.json", "hole.json: has more than 2^31 - 1 bytes"},
      {"--stiffness hole.mtx", "hole.mtx: has more than 2^31 - 1 bytes"},
      {"'short hole.obj'", "short hole.obj:6: a zero byte"},
      {"'short hole.json'", "short hole.json:2: a zero byte"},
      {"--stiffness 'short hole.mtx'", "short hole.mtx:3: a zero byte"},
      {"book.obj", "book.obj:204: face is one of more than 100 at the edge 1-2"},
      {"book.obj --material baraff-witkin", "book.obj: more than 100 triangles at the edge 1-2"},
      {"--grid 4000x5000", "not enough memory"},
      {"utf16.obj", "utf16.obj:1: a zero byte, expected text in ASCII or UTF-8"},
      {"/dev/zero", "/dev/zero: is a device"},
      {"/dev/null", "/dev/null: is a device"},
      {"endless.json", "/dev/zero: is a device"},
      {"fifo.obj", "fifo.obj: the file is empty"},
      {"--stiffness directory.mtx", "directory.mtx: cannot be read (Is a directory)"},
      {"directory.json", "directory.json: cannot be read (Is a directory)"},
      {"--stiffness /proc/self/mem", "/proc/self/mem: cannot be read (Input/output error)"},
      {"--stiffness wide.mtx", "wide.mtx:2: a matrix of 1000000000 by 1000000000"},
      {"--stiffness long.mtx", "long.mtx:2: the size line announces 1000000000 entries"},
      {"--stiffness array.mtx", "array.mtx:2: the size line announces"},
      {"--stiffness long.rsa", "long.rsa:2: 1000000002 lines"},
      {"grid.json", "grid.json:1: 'grid'[0] is 1000000000"},
      {"--grid 1000000000x1000000000", "1000000000 x 1000000000"},
      {"--grid 2x2 --pin 0-19999999,1-19999998", "pinned particle 19999999 does not exist"},
      {"pins.json", "pins.json:1: pinned particle 19999999 does not exist"},
  };
  for (const auto& [input, word] : cases)
    if (limits_memory || word != "not enough memory")
      check_refused(shell(in_little_memory + "\"$springstab\" limits " + input), word);

  file("secret.obj", cloth);
  fs::permissions(folder() / "secret.obj", fs::perms::none);
  if (geteuid() != 0) check_refused((*this)("limits secret.obj"), "secret.obj: cannot be opened (Permission");
}

// A BLAS may start threads that wait for memory without end.
BOOST_AUTO_TEST_CASE(a_limit_of_address_space_does_not_keep_a_command_from_ending) {
  if (!limits_memory) return;
  file("k.mtx", matrix);
  const std::string line = "timeout 30 \"$springstab\" limits --stiffness k.mtx --json";
  const Outcome plain = shell(line), limited = shell("ulimit -v 200000; " + line);
  BOOST_TEST(limited.status == 0);
  BOOST_TEST(without_cheapest(limited.out) == without_cheapest(plain.out));
}

BOOST_AUTO_TEST_CASE(what_comes_through_a_pipe_is_read_to_its_end) {
  file("k.mtx", matrix);
  const std::string plain = (*this)("limits --stiffness k.mtx --json").out;
  BOOST_TEST(!plain.empty());
  for (const std::string line : {
           "cat k.mtx | \"$springstab\" limits --stiffness /dev/stdin --json",
           "(sleep 0.1; head -n 3 k.mtx; sleep 0.1; tail -n +4 k.mtx) | "
           "\"$springstab\" limits --stiffness /dev/stdin --json",
           "mkfifo named; (sleep 0.1; cat k.mtx > named) & \"$springstab\" limits --stiffness named --json",
           "\"$springstab\" limits --stiffness /dev/stdin --json < k.mtx",
       })
    BOOST_TEST_CONTEXT(line) {
      const Outcome piped = shell(line);
      BOOST_TEST(piped.status == 0);
      BOOST_TEST(piped.out == plain);
    }
}

BOOST_AUTO_TEST_CASE(a_stdout_that_takes_nothing_is_noticed) {
  file("cloth.obj", cloth);
  for (const std::string arguments :
       {"limits cloth.obj --method symplectic-euler --json", "limits cloth.obj --method symplectic-euler",
        "methods", "methods --json", "region rk4 --nx 2 --ny 2 --json",
        "simulate cloth.obj --method rk4 --duration 0.01 --step 0.001 --json", "--help", "limits --help",
        "--version"})
    for (const std::string stdout_of : {" >/dev/full", " >&-"})
      check_refused((*this)(arguments + stdout_of), "stdout: cannot be written");
  // A diverged run stays one.
  BOOST_TEST((*this)("simulate --grid 8x8 --pin corners --method symplectic-euler --duration 1 --step 0.01 "
                     ">/dev/full")
                 .status == 4);
}

/// Every option that writes files, into the file or folder %.
const std::vector<std::string> writers = {
    "region rk4 --nx 100 --ny 100 --raster %",
    "region rk4 --boundary %",
    "region rk4 --pieces %",
    "region rk4 --simulate 40 --cells %",
};
const std::vector<std::string> folder_writers = {
    "simulate --grid 20x20 --pin corners --method symplectic-euler --step 1e-4 --duration 0.01 --output %",
    "simulate --grid 20x20 --pin corners --method symplectic-euler --step 1e-4 --duration 0.01 --format vtk "
    "--output %",
    "simulate --stiffness k.mtx --method rk4 --step 1e-3 --duration 1 --frames 1000 --output %",
    "stress --filter 'mass ratio' --output %",
};

std::string to(std::string writer, const std::string& where) {
  return writer.replace(writer.find('%'), 1, where);
}

BOOST_AUTO_TEST_CASE(a_file_that_cannot_be_written_to_its_end_is_not_there) {
  file("k.mtx", matrix);
  // No file may grow beyond 512 bytes (or 1 kB, as the shell counts): writing fails in the middle. (An
  // instrumented build's counts could not be written either.)
  const std::string full = "trap '' XFSZ; ulimit -f 1; export LLVM_PROFILE_FILE=/dev/null; ";
  const auto only_whole_files = [&](const fs::path& folder) {
    if (fs::exists(folder))
      for (const auto& entry : fs::directory_iterator(folder)) {
        BOOST_TEST_CONTEXT(entry.path()) {
          BOOST_TEST(entry.path().string().find(".part") == std::string::npos);
          BOOST_TEST(entry.file_size() < 1024);
        }
      }
  };
  for (const std::string& writer : writers) BOOST_TEST_CONTEXT(writer) {
      const auto before = names(folder());
      check_refused(shell(full + "\"$springstab\" " + to(writer, "out.csv")), "out.csv: cannot be written");
      BOOST_TEST(names(folder()) == before, boost::test_tools::per_element());
    }
  for (const std::string& writer : folder_writers) BOOST_TEST_CONTEXT(writer) {
      const Outcome run = shell(full + "\"$springstab\" --quiet " + to(writer, "there"));
      BOOST_TEST(run.status == 2);
      BOOST_TEST(run.err.find("cannot be written") != std::string::npos);
      only_whole_files(folder() / "there");
      fs::remove_all(folder() / "there");
    }
}

BOOST_AUTO_TEST_CASE(a_full_disk_is_said_and_keeps_what_was_there) {
  file("k.mtx", matrix);
  const std::string mount = "mkdir disk && mount -t tmpfs -o size=64k springstab disk";
  if (shell(mount).status != 0) {
    BOOST_TEST_MESSAGE("skipped, for a small disk cannot be mounted");
    return;
  }
  const fs::path disk = folder() / "disk";
  std::ofstream(disk / "raster.csv") << "what was there\n";
  const Outcome raster = (*this)("region rk4 --nx 300 --ny 300 --raster disk/raster.csv");
  const std::string kept = shell("cat disk/raster.csv").out;
  const Outcome frames = (*this)("simulate " + std::string("--grid 20x20 --pin corners --method rk4 ") +
                                 "--step 1e-4 --duration 0.01 --output disk/frames");
  const Outcome last =
      shell("tail -q -c 1 disk/frames/* | tr -d '\\n' | wc -c; ls disk/frames | grep -c part");
  shell("umount disk");
  check_refused(raster, "disk/raster.csv: cannot be written: No space left on device");
  BOOST_TEST(kept == "what was there\n");
  check_refused(frames, "cannot be written: No space left on device");
  BOOST_TEST(last.out == "0\n0\n");  // every frame ends in a line feed, and none is a part
}

BOOST_AUTO_TEST_CASE(devices_pipes_and_links_stay_what_they_are) {
  check_refused((*this)("region rk4 --nx 2 --ny 2 --raster /dev/full"), "/dev/full: cannot be written");
  BOOST_TEST((*this)("region rk4 --nx 2 --ny 2 --raster /dev/null").status == 0);
  BOOST_TEST(fs::is_character_file("/dev/full"));
  BOOST_TEST(fs::is_character_file("/dev/null"));

  const Outcome piped = shell("\"$springstab\" region rk4 --nx 2 --ny 3 --raster /dev/fd/3 3>&1 >/dev/null");
  BOOST_TEST(piped.status == 0);
  BOOST_TEST(piped.out.starts_with("x,y,spectral_radius\n"));
  BOOST_TEST(lines(piped.out) == 7);

  file("real.csv", "old");
  fs::create_symlink("real.csv", folder() / "link.csv");
  BOOST_TEST((*this)("region rk4 --nx 2 --ny 3 --raster link.csv").status == 0);
  BOOST_TEST(fs::is_symlink(folder() / "link.csv"));
  BOOST_TEST(shell("cat real.csv").out == piped.out);

  fs::create_directory(folder() / "folder.csv");
  check_refused((*this)("region rk4 --nx 2 --ny 2 --raster folder.csv"), "folder.csv: cannot be written");
  check_refused((*this)("simulate --grid 3x3 --method rk4 --step 1e-3 --duration 0.01 --output real.csv"),
                "real.csv: cannot be made a folder");
  check_refused((*this)("region rk4 --nx 2 --ny 2 --raster " + std::string(300, 'x')), "File name too long");
}

BOOST_AUTO_TEST_CASE(names_may_be_in_any_language) {
  const std::string mesh = "Häkeldecke 綾取り ✂.obj";
  file(mesh, cloth);
  file("scène.json", R"({"geometry": {"mesh": ")" + mesh + R"("}})");
  file("kaputt ß.obj", "v 0 0 nichts\n");
  const std::string plain = (*this)("limits '" + mesh + "' --json").out;
  BOOST_TEST(!plain.empty());
  BOOST_TEST((*this)("limits scène.json --json").out == plain);
  check_refused((*this)("limits 'kaputt ß.obj'"), "kaputt ß.obj:1: 'nichts' is not a number");
  BOOST_TEST(
      (*this)("simulate '" + mesh + "' --method rk4 --step 1e-3 --duration 0.01 --output Größe").status == 0);
  BOOST_TEST(fs::exists(folder() / "Größe" / "frame_00000.obj"));

  const Outcome stress = (*this)("stress --filter 'one mass' --output 'no\xff' --json");  // not UTF-8
  BOOST_TEST(stress.status == 0);
  BOOST_TEST(stress.out.find("no\uFFFD") != std::string::npos);
  BOOST_TEST(fs::exists(folder() / "no\xff"));
}

// In Germany 2.5 is written 2,5: everything that is read and written stays as it is.
BOOST_AUTO_TEST_CASE(a_decimal_comma_changes_nothing, *boost::unit_test::label("slow")) {
  const std::string german = "export LOCPATH=\"$PWD\" LC_ALL=de_DE.UTF-8; ";
  shell("localedef -i de_DE -f UTF-8 \"$PWD/de_DE.UTF-8\"");
  if (shell(german + "locale decimal_point").out != ",\n") {
    BOOST_TEST_MESSAGE("skipped, for there is no German locale");
    return;
  }
  file("k.mtx", matrix);
  file("cloth.obj", cloth);
  file("scene.json", R"({"geometry": {"mesh": "cloth.obj"}, "gravity": [0.5, -9.81, 0], "pins": "0"})");
  for (const std::string& arguments : std::vector<std::string>{
           "limits --stiffness k.mtx --json", "limits --stiffness k.mtx", "limits scene.json --safety 1.25",
           "region rk4 --x 0:2.5 --nx 3 --ny 3 --raster /dev/fd/3 --json 3>&1",
           ("simulate --stiffness k.mtx --method rk4 --step 0.05 --duration 0.5 --output out >/dev/null && "
            "cat out/*"),
           ("simulate scene.json --method rk4 --step 0.0005 --duration 0.005 --output frames >/dev/null && "
            "cat frames/*")})
    BOOST_TEST_CONTEXT(arguments) {
      const Outcome here = (*this)(arguments), there = shell(german + "\"$springstab\" " + arguments);
      BOOST_TEST(here.status == 0);
      BOOST_TEST(here.out.find('.') != std::string::npos);
      BOOST_TEST((without_cheapest(here.out) == without_cheapest(there.out)));
    }
}

BOOST_AUTO_TEST_SUITE_END()
