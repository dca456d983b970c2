// `springstab report`: one page that says what `limits` says, is well-formed, asks for nothing elsewhere, and
// is written whole or not at all.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "experiments/report/obstacle_faces.h"
#include "experiments/report/page.h"
#include "experiments/report/svg_figure.h"
#include "tests/command.h"
#include "tests/places.h"

BOOST_FIXTURE_TEST_SUITE(report, springstab::test::Command)

namespace fs = std::filesystem;
using Json = nlohmann::json;
using springstab::test::Command;
using springstab::test::content_of;
using springstab::test::Outcome;
using springstab::test::source_folder;

namespace {

long count(const std::string& text, const std::string& words) {
  long n = 0;
  for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; at += words.size()) ++n;
  return n;
}

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  BOOST_REQUIRE_MESSAGE(from != std::string::npos, "the page has no " << begin);
  const std::size_t to = text.find(end, from + begin.size());
  BOOST_REQUIRE(to != std::string::npos);
  return text.substr(from + begin.size(), to - from - begin.size());
}

/// A page as a strict reader of XML takes it: every tag is closed in order and every attribute quoted.
struct ReadPage {
  std::vector<std::string> ids, references, sources;
  std::string fault;

  explicit ReadPage(const std::string& page) {
    std::vector<std::string> open;
    for (std::size_t at = 0; (at = page.find('<', at)) != std::string::npos && fault.empty();) {
      const std::size_t end = page.find('>', at);
      if (end == std::string::npos) {
        fault = "a tag has no end";
        return;
      }
      std::string tag = page.substr(at + 1, end - at - 1);
      at = end;
      if (tag.starts_with('!')) continue;
      const bool empty = tag.ends_with('/');
      if (empty) tag.pop_back();
      const std::string name = tag.substr(0, tag.find_first_of(" \n\t"));
      if (name.starts_with('/')) {
        if (open.empty() || "/" + open.back() != name)
          fault = "<" + name + "> closes " + (open.empty() ? "nothing" : open.back());
        if (!open.empty()) open.pop_back();
        continue;
      }
      read_attributes(tag.substr(name.size()));
      if (!empty) open.push_back(name);
    }
    if (fault.empty() && !open.empty()) fault = open.back() + " is not closed";
  }

 private:
  void read_attributes(const std::string& text) {
    std::set<std::string> names;
    for (std::size_t at = 0; (at = text.find_first_not_of(" \n\t", at)) != std::string::npos;) {
      const std::size_t equals = text.find('=', at);
      const std::size_t quote =
          equals == std::string::npos ? equals : text.find_first_not_of(" \n\t", equals + 1);
      if (quote == std::string::npos || (text[quote] != '"' && text[quote] != '\''))
        return void(fault = "not quoted:" + text);
      const std::size_t end = text.find(text[quote], quote + 1);
      if (end == std::string::npos) return void(fault = "quote not closed:" + text);
      std::string name = text.substr(at, equals - at);
      name.erase(name.find_last_not_of(" \n\t") + 1);
      add(name, text.substr(quote + 1, end - quote - 1));
      if (!names.insert(name).second) fault = name + " stands twice:" + text;
      at = end + 1;
    }
  }

  void add(const std::string& name, const std::string& value) {
    if (name == "id") ids.push_back(value);
    if (name == "src" || name == "srcset" || name == "data") sources.push_back(value);
    if (name == "href" || name == "xlink:href")
      (value.starts_with('#') ? references : sources).push_back(value);
    if (name == "aria-labelledby")
      for (std::size_t at = 0; at < value.size();) {
        const std::size_t space = std::min(value.find(' ', at), value.size());
        references.push_back("#" + value.substr(at, space - at));
        at = space + 1;
      }
  }
};

void check_page(const std::string& page) {
  const ReadPage read(page);
  BOOST_TEST(read.fault == "");
  const std::set<std::string> ids(read.ids.begin(), read.ids.end());
  BOOST_TEST(ids.size() == read.ids.size(), "an id stands twice");
  for (const std::string& reference : read.references)
    BOOST_TEST(ids.contains(reference.substr(1)), "nothing has the id " << reference);
  for (const std::string& source : read.sources) BOOST_TEST(source.starts_with("data:"), source);
  for (const char* words : {"http:", "https:", "@import", "url(", " nan", ">nan", "-nan", "<script>"})
    BOOST_TEST(!has(page, words), words);
  BOOST_TEST(count(page, "<svg") == count(page, "role=\"img\""));
}

Json limits_in(const std::string& page) {
  return Json::parse(between(page, "<script type=\"application/json\" id=\"limits-json\">", "</script>"));
}

std::string cell(const Json& value) {
  if (value.is_null()) return "–";
  if (value.is_string()) return "∞";
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value.get<double>());
  return text;
}

// The row of each method in the table has these numbers and no others.
void check_table(const std::string& page, const Json& limits) {
  for (const Json& m : limits["methods"]) {
    const std::string name = m["name"],
                      row = between(page, "<tr><th scope=\"row\">" + name + "</th>", "</tr>");
    std::string expected = "<td>" + m["status"].get<std::string>() + "</td>";
    for (const char* key : {"h_max", "h_certified", "recommended_step"})
      expected += "<td>" + cell(m[key]) + "</td>";
    BOOST_TEST(row.starts_with(expected), row << " does not start with " << expected);
  }
}

bool there_is(const Command& command, const char* program) {
  return command.shell(std::string("command -v ") + program).status == 0;
}

// Chromium on a page, with more options.
Outcome browse(const Command& command, const std::string& options) {
  return command.shell("chromium --headless --disable-gpu --no-sandbox --user-data-dir=\"$PWD/profile\" " +
                       options + " \"$PWD/r.html\"");
}

}  // namespace

BOOST_AUTO_TEST_CASE(the_page_says_what_limits_says, *boost::unit_test::label("slow")) {
  const std::string input = "--grid 6x5 --pin first-row ";
  const Outcome made = (*this)("report " + input + "--step 1e-3 --duration 0.01 -o r.html --json --quiet");
  BOOST_REQUIRE_MESSAGE(made.status == 0, made.err);
  BOOST_TEST(made.json()["files"] == Json{"r.html"});
  BOOST_TEST(made.json()["seconds"].get<double>() > 0);
  const std::string page = content_of(folder() / "r.html");
  check_page(page);
  const Json limits = (*this)("limits " + input + "--for-step 1e-3 --json").json();
  BOOST_TEST(limits_in(page) == limits);
  check_table(page, limits);
  const std::string command = between(page, "<h2 id=\"command\">", "</section>");
  BOOST_TEST(has(command, "report --grid 6x5 --pin first-row --step 1e-3"), command);
  // At that step symplectic Euler does not hold, and every implicit method does.
  BOOST_TEST(
      has(between(page, "class=\"answer\">", "</p>"), "At your step of 0.001 s these hold: implicit-euler"));
  if (there_is(*this, "gnuplot")) {
    BOOST_TEST(count(page, "<svg") == 4);  // two regions, errors, k0
    BOOST_TEST(count(page, "<img src=\"data:image/png;base64,iVBORw0KGgo") == 1);
  }
}

// A scene with dampers, one of triangles, a solid, matrices with damping of their own: each has its sections.
BOOST_AUTO_TEST_CASE(every_kind_of_input_has_a_page, *boost::unit_test::label("slow")) {
  const std::string sources = source_folder();
  file("K.mtx",
       "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 200\n2 1 -100\n2 2 200\n3 2 -100\n3 3 "
       "100\n");
  file("D.mtx", "%%MatrixMarket matrix coordinate real symmetric\n3 3 1\n1 1 0.7\n");
  const struct {
    std::string input, words;
  } cases[] = {
      {"'" + sources + "/experiments/scenes/gallery/dampers.json'", "its joint numerical range"},
      {"--grid 5x4 --material baraff-witkin --pin corners", "on the thick line"},
      {"'" + sources + "/experiments/scenes/beam.veg' --pin 0-3", "on the thick line"},
      {"--stiffness K.mtx --damping-matrix D.mtx", "of matrices k0 stays what it is"},
  };
  for (const auto& [input, words] : cases) {
    const Outcome made = (*this)("report " + input + " --duration 0.005 -o r.html --quiet");
    BOOST_REQUIRE_MESSAGE(made.status == 0, input << ": " << made.err);
    const std::string page = content_of(folder() / "r.html");
    check_page(page);
    check_table(page, limits_in(page));
    BOOST_TEST(limits_in(page) == (*this)("limits " + input + " --json").json());
    if (there_is(*this, "gnuplot")) BOOST_TEST(has(page, words), input << " has no " << words);
  }
}

BOOST_AUTO_TEST_CASE(warnings_stand_in_the_page_as_the_command_prints_them) {
  const Outcome made =
      (*this)("report --grid 4x4 --spacing 25 --pin corners --duration 0.01 -o r.html --quiet");
  BOOST_REQUIRE(made.status == 0);
  const std::string warning = between(made.err, "springstab: warning: ", "\n");
  BOOST_TEST(has(warning, "more than 20 m"));
  BOOST_TEST(has(content_of(folder() / "r.html"), springstab::escaped(warning)));
}

BOOST_AUTO_TEST_CASE(without_gnuplot_the_page_has_no_pictures) {
  const Outcome made =
      shell("PATH= \"$springstab\" report --grid 4x4 --pin corners --duration 0.01 -o r.html --quiet");
  BOOST_REQUIRE_MESSAGE(made.status == 0, made.err);
  BOOST_TEST(springstab::test::lines(made.err) == 1);
  BOOST_TEST(has(made.err, "gnuplot was not found"));
  const std::string page = content_of(folder() / "r.html");
  check_page(page);
  BOOST_TEST(count(page, "<svg") + count(page, "<img") == 0);
  BOOST_TEST(has(page, "gnuplot was not found"));
}

BOOST_AUTO_TEST_CASE(what_fails_leaves_no_page_and_the_earlier_one) {
  file("r.html", "earlier");
  const auto untouched = [&] {
    const bool one = std::distance(fs::directory_iterator(folder()), {}) == 1;
    return one && content_of(folder() / "r.html") == "earlier";
  };
  for (const char* arguments :
       {"missing.obj -o r.html", "--grid 4x4 -o nowhere/r.html", "--grid 4x4 -o r.html --pdf r.html",
        "--grid 4x4 -o r.html --step 0", "--grid 4x4 -o r.html --plots .",
        "--grid 4x4 -o r.html --duration -1", "--grid 4x4 -o r.html --methods nonsense"}) {
    const Outcome refused = (*this)(std::string("report ") + arguments);
    BOOST_TEST(refused.status == 2, arguments);
    BOOST_TEST(springstab::test::lines(refused.err) == 1, refused.err);
    BOOST_TEST(untouched(), arguments);
  }
  const Outcome unprinted = shell("PATH= \"$springstab\" report --grid 4x4 -o r.html --pdf r.pdf");
  BOOST_TEST(unprinted.status == 2);
  BOOST_TEST(has(unprinted.err, "Chromium"));
  BOOST_TEST(untouched());
  // Ctrl-C, long before the end.
  const Outcome stopped = shell(
      "\"$springstab\" report --grid 60x60 --pin first-row -o r.html --quiet & sleep 0.3; kill -INT $!; wait "
      "$!");
  BOOST_TEST(stopped.status == 130);
  BOOST_TEST(has(stopped.err, "interrupted; nothing was saved"));
  BOOST_TEST(untouched());
}

// A browser takes the page as it is, shows it light or dark, and prints it.
BOOST_AUTO_TEST_CASE(chromium_shows_the_page_without_a_complaint) {
  if (!there_is(*this, "chromium") || !there_is(*this, "gnuplot")) return;
  const Outcome made =
      (*this)("report --grid 6x5 --pin first-row --duration 0.01 -o r.html --pdf r.pdf --json --quiet");
  BOOST_REQUIRE_MESSAGE(made.status == 0, made.err);
  BOOST_TEST(made.json()["files"].size() == 2);
  BOOST_TEST(content_of(folder() / "r.pdf").starts_with("%PDF-"));
  std::string shown[2];
  for (const int light : {0, 1}) {
    const Outcome seen = browse(*this,
                                "--enable-logging=stderr --window-size=900,1600 --screenshot=shot.png "
                                "--blink-settings=preferredColorScheme=" +
                                    std::to_string(light));
    BOOST_TEST(seen.status == 0);
    BOOST_TEST(!has(seen.err, "CONSOLE"), seen.err);
    shown[light] = content_of(folder() / "shot.png");
    BOOST_TEST(shown[light].starts_with("\x89PNG"));
  }
  BOOST_TEST(shown[0] != shown[1]);
  // What the browser made of it has all that was written.
  const std::string dom = browse(*this, "--dump-dom").out;
  for (const char* part : {"<svg", "<h2", "<td", "<li", "<img"})
    BOOST_TEST(count(dom, part) == count(content_of(folder() / "r.html"), part), part);
}

// --picture: a PNG of one state, a GIF of as many as there are, and one line where there can be none.
BOOST_AUTO_TEST_CASE(a_quick_look_is_a_picture_of_the_run) {
  if (!there_is(*this, "gnuplot")) return;
  const std::string run =
      "simulate --grid 5x4 --pin corners --method symplectic-euler --duration 0.1 --json --picture ";
  const nlohmann::json still = (*this)(run + "end.png").json();
  BOOST_TEST(content_of(folder() / "end.png").starts_with("\x89PNG"));
  nlohmann::json moving = (*this)(run + "run.gif").json();
  BOOST_TEST(moving["last_particle"] == still["last_particle"]);
  const std::string gif = content_of(folder() / "run.gif");
  BOOST_TEST(gif.starts_with("GIF89a"));
  BOOST_TEST(gif.ends_with(";"));
  BOOST_TEST(count(gif, std::string("\x21\xf9\x04", 3)) == 61);  // a graphic control extension a frame
  BOOST_TEST((*this)("limits --grid 5x4 --picture scene.png").status == 0);
  BOOST_TEST(content_of(folder() / "scene.png").starts_with("\x89PNG"));
  file("K.mtx", "%%MatrixMarket matrix coordinate real symmetric\n1 1 1\n1 1 4\n");
  for (const char* arguments :
       {"limits --grid 4x4 --picture scene.gif", "limits --stiffness K.mtx --picture k.png",
        "simulate --grid 4x4 --method rk4 --duration 0.01 --picture run.jpg",
        "simulate --grid 4x4 --method rk4 --duration 0.01 --picture nowhere/run.png"}) {
    const Outcome refused = (*this)(arguments);
    BOOST_TEST(refused.status == 2, arguments);
    BOOST_TEST(springstab::test::lines(refused.err) == 1, refused.err);
  }
  BOOST_TEST(!fs::exists(folder() / "k.png"));
}

// What is drawn of obstacles lies on them where they are at that time, is all of a ball and of a mesh in
// sight (by its area, of a ball to the second order in the faces' size), of a plane what is in sight, and
// small.
BOOST_AUTO_TEST_CASE(obstacles_are_drawn_where_they_are) {
  using Eigen::Vector3d;
  const double size = 0.05, t = 0.7, radius = 0.4;
  const Vector3d u(0.3, -0.2, 0.1), normal = Vector3d(0.1, 1, -0.2).normalized();
  const Eigen::AlignedBox3d sight(Vector3d(-1, -1, -1), Vector3d(1, 1, 1));
  const auto drawn = [&](const springstab::Contact& contact, double& area, double& longest) {
    const springstab::PlacedFaces all = springstab::obstacle_faces(contact, t, sight, size);
    area = longest = 0;
    for (const std::vector<int>& face : all.faces)
      for (std::size_t k = 1; k < face.size(); ++k) {
        const Vector3d &a = all.places[face[0]], &b = all.places[face[k - 1]], &c = all.places[face[k]];
        area += (b - a).cross(c - a).norm() / 2;
        longest = std::max(longest, (c - b).norm());
      }
    BOOST_TEST(longest <= std::numbers::sqrt2 * size);
    BOOST_TEST(longest > size / 3);
    return all.places;
  };
  double area, longest;
  springstab::Contact ball, plane, mesh;
  ball.obstacles = {{springstab::Sphere{{0.1, 0, 0}, radius}, u}};
  for (const Vector3d& at : drawn(ball, area, longest))
    BOOST_TEST(std::abs(springstab::gap_at(ball.obstacles[0], at, t).gap) < 1e-14);
  const double whole = 4 * std::numbers::pi * radius * radius, bends = size * size / (radius * radius);
  BOOST_TEST(area < whole);
  BOOST_TEST(area > whole * (1 - bends));
  plane.obstacles = {{springstab::Plane{{0.2, 0.1, 0.3}, normal}, u}};
  for (const Vector3d& at : drawn(plane, area, longest)) {
    BOOST_TEST(std::abs(springstab::gap_at(plane.obstacles[0], at, t).gap) < 1e-14);
    BOOST_TEST(sight.exteriorDistance(at) <= size);
  }
  // It cuts the cube across, above a square of 2 × 2, or to within a face of its border.
  BOOST_TEST(std::abs(area * normal.y() - 4) < 8 * size);
  mesh.meshes = {
      {{{0, 0, 0}, {0.5, 0, 0}, {0, 0.3, 0.4}, {9, 9, 9}, {9, 8, 9}, {8, 9, 9}}, {{0, 1, 2}, {3, 4, 5}}, u}};
  drawn(mesh, area, longest);
  BOOST_TEST(std::abs(area - 0.125) < 1e-14);
}

BOOST_AUTO_TEST_CASE(text_is_escaped_and_pictures_are_made_fit) {
  BOOST_TEST(springstab::escaped("<a href='x'>&\"\x01") == "&lt;a href=&#39;x&#39;&gt;&amp;&quot;");
  springstab::Page page("a<b", "c&d");
  page.json("j", R"({"k":"</script>&"})");
  const std::string text = page.text();
  BOOST_TEST(ReadPage(text).fault == "");
  BOOST_TEST(Json::parse(between(text, "id=\"j\">", "</script>"))["k"] == "</script>&");
  BOOST_TEST(springstab::data_url("t", "Man") == "data:t;base64,TWFu");
  BOOST_TEST(springstab::data_url("t", "Ma") == "data:t;base64,TWE=");
  BOOST_TEST(springstab::data_url("t", "M") == "data:t;base64,TQ==");
  const std::string svg =
      "<?xml version='1.0'?>\n<svg \n viewBox=\"0 0 2 1\"\n "
      "xmlns=\"x\">\n<title>Gnuplot</title>\n<desc>by</desc>\n"
      "<g id=\"gnuplot_plot_1\" ><path id='gpPt0' stroke='rgb(213,  94,   0)'/></g>"
      "<g id=\"gnuplot_plot_1\" ><use xlink:href='#gpPt0' color='rgb(  1,   2,   3)' "
      "fill='black'/></g></svg>\n";
  const std::string fit = springstab::svg_figure(svg, "p", "T", "D");
  BOOST_TEST(fit ==
             "<svg viewBox=\"0 0 2 1\" role=\"img\" aria-labelledby=\"p-title p-desc\">\n<title "
             "id=\"p-title\">T</title>\n"
             "<desc id=\"p-desc\">D</desc>\n\n\n\n<g ><path id='p-gpPt0' stroke='var(--cd55e00)'/></g>"
             "<g ><use href='#p-gpPt0' color='rgb(  1,   2,   3)' fill='currentColor'/></g></svg>\n");
  BOOST_CHECK_THROW(springstab::svg_figure("no picture", "p", "T", "D"), std::runtime_error);
}

BOOST_AUTO_TEST_SUITE_END()
