#include "experiments/report/pictures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "experiments/command/output.h"
#include "experiments/command/programs.h"
#include "experiments/command/shared_options.h"
#include "experiments/region.h"
#include "experiments/report/obstacle_faces.h"
#include "experiments/studies/gnuplot.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr std::size_t most_faces = 300'000, most_marks = 2000;
constexpr Eigen::Index most_pixels = 700;  // a side, of a matrix
constexpr double farthest_shown = 2.5;     // of the region
constexpr int film_frames = 60;            // after the first

std::string load(const std::string& plots, const std::string& script) {
  return "load " + gnuplot_literal(plots + "/" + script) + "\n";
}

std::string setting(const char* name, double value) { return text("%s=%.9g\n", name, value); }

std::string point(const Eigen::Vector3d& at) { return text("%.6g,%.6g,%.6g\n", at.x(), at.z(), at.y()); }

// What is in sight: the physical quadrant, the region as far as it goes, and the modes, but not far beyond.
Window window_for(const StabilityRegion& region, const std::vector<const ModesAtStep*>& all) {
  double x = 0, y = 0;
  for (const ModesAtStep* each : all)
    for (const ModePoint& p : each->modes.outline) {
      x = std::max(x, each->h * p.d);
      y = std::max(y, each->h * each->h * p.k);
    }
  const bool bounded = std::isfinite(region.constants().y_max);
  const Window natural = region.natural_window(0.08);
  const auto far = [&](double reached, double size) {
    return bounded ? std::max(size, std::min(1.1 * reached, farthest_shown * size))
                   : std::max(1., 1.3 * reached);
  };
  const double x_max = far(x, natural.x_max), y_max = far(y, natural.y_max);
  return {-0.04 * x_max, x_max, -0.04 * y_max, y_max};
}

std::string pieces_of(const StabilityRegion& region, const Window& window) {
  std::string rows;
  for (const RegionPiece& piece : region.pieces(window)) {
    for (std::size_t i = 0; i < piece.x.size(); ++i)
      rows += text("%.6g,%.6g,%.6g\n", piece.x[i], piece.y_lower[i], piece.y_upper[i]);
    rows += '\n';
  }
  return rows;
}

std::string boundary_of(const StabilityRegion& region, const Window& window) {
  std::string rows;
  for (const BoundaryArc& arc : region.boundary(window)) {
    if (arc.bound == Bound::window) continue;
    for (std::size_t i = 0; i < arc.x.size(); ++i) rows += text("%.6g,%.6g\n", arc.x[i], arc.y[i]);
    rows += '\n';
  }
  return rows;
}

std::string modes_of(const ModesAtStep& modes) {
  std::string rows;
  for (const ModePoint& p : modes.modes.outline)
    rows += text("%.6g,%.6g\n", modes.h * p.d, modes.h * modes.h * p.k);
  return rows;
}

using Places = std::vector<Eigen::Vector3d>;

// Each face closed, as plots/scene.gp reads them.
std::string corners_of(const Faces& faces, const Places& at) {
  std::string rows;
  for (const std::vector<int>& face : faces) {
    for (std::size_t c = 0; c <= face.size(); ++c) rows += point(at[face[c % face.size()]]);
    rows += "\n\n";
  }
  return rows;
}

struct Frame {
  double time;  // [s]
  Places at;
};

constexpr double faces_a_side = 24;  // of obstacles, along the cube that is seen

// The cube that is seen: around the cloth, and as far again for balls and meshes.
struct Sight {
  Eigen::Vector3d middle;
  double half;

  Sight(const Subject& subject, const std::vector<Frame>& frames) {
    Eigen::AlignedBox3d box;
    for (const Frame& frame : frames)
      for (const Eigen::Vector3d& at : frame.at)
        if (at.allFinite()) box.extend(at);
    if (subject.contact()) {
      const Eigen::Array3d more = Eigen::Array3d::Constant(box.sizes().maxCoeff());
      const Eigen::AlignedBox3d most(box.min().array() - more, box.max().array() + more);
      for (const Frame& frame : frames)
        box.extend(box_of_obstacles(*subject.contact(), frame.time).intersection(most));
    }
    middle = box.center();
    half = std::max(box.sizes().maxCoeff() / 2, 1e-9);
  }
  Eigen::AlignedBox3d cube() const { return {middle.array() - half, middle.array() + half}; }
};

// How all frames are seen: `kind` is page, white or gif.
std::string view_of(const Sight& sight, const std::string& kind, bool edges) {
  return setting("x_mid", sight.middle.x()) + setting("y_mid", sight.middle.y()) +
         setting("z_mid", sight.middle.z()) + setting("half", sight.half) + setting("edges", edges) +
         "kind='" + kind + "'\nfirst=1\n";
}

std::string obstacles_of(const Subject& subject, double t, const Sight& sight) {
  if (!subject.contact()) return setting("has_obstacles", 0);
  const double size = 2 * sight.half / faces_a_side;
  Contact planes, others = *subject.contact();
  std::ranges::copy_if(others.obstacles, std::back_inserter(planes.obstacles), is_flat);
  std::erase_if(others.obstacles, is_flat);
  std::string lines = setting("has_obstacles", 1) + setting("behind", size);
  for (const auto& [name, some] : {std::pair{"planes", planes}, {"obstacles", others}}) {
    const PlacedFaces all = obstacle_faces(some, t, sight.cube(), size);
    lines += gnuplot_data(name, corners_of(all.faces, all.places));
  }
  return lines;
}

constexpr std::size_t most_with_edges = 20'000;  // faces

std::string drawn_frames(const Subject& subject, const std::vector<Frame>& frames, const std::string& kind) {
  const std::string plots = plots_folder();
  const Sight sight(subject, frames);
  std::string lines =
      view_of(sight, kind, subject.faces().size() < most_with_edges) + "has_pins=0\nhas_stiff=0\n";
  for (const Frame& frame : frames)
    lines += gnuplot_data("faces", corners_of(subject.faces(), frame.at)) +
             obstacles_of(subject, frame.time, sight) + load(plots, "scene.gp");
  return drawn(lines);
}

void write_drawing(const std::string& path, const std::string& drawing) {
  OutputFile file(path);
  file.stream() << drawing;
  file.commit();
}

std::string marks_of(const Subject& subject, const std::vector<Eigen::Vector3d>& at) {
  const std::vector<long> all = subject.vertex_numbers();
  std::vector<long> free = subject.particle_numbers();
  std::ranges::sort(free);
  std::string rows;
  std::size_t marks = 0;
  for (const long vertex : all)
    if (!std::ranges::binary_search(free, vertex) && ++marks <= most_marks)
      rows += point(at[static_cast<std::size_t>(vertex)]);
  return marks <= most_marks ? rows : "";
}

}  // namespace

std::string scene_picture(const std::string& plots, const Subject& subject, const Vector& x,
                          const std::vector<std::vector<long>>& stiffest) {
  const Faces& faces = subject.faces();
  if (faces.empty() || faces.size() > most_faces) return {};
  const std::vector<Eigen::Vector3d> at = subject.vertices(x);
  std::string stiff;
  for (const std::vector<long>& element : stiffest) {
    for (std::size_t c = 0; c <= element.size(); ++c)
      stiff += point(at[static_cast<std::size_t>(element[c % element.size()])]);
    stiff += "\n\n";  // else gnuplot joins the lines to a net
  }
  const std::string pins = marks_of(subject, at);
  const Sight sight(subject, {{0, at}});
  return drawn(gnuplot_data("faces", corners_of(faces, at)) + gnuplot_data("pins", pins) +
               gnuplot_data("stiff", stiff) + setting("has_pins", !pins.empty()) +
               setting("has_stiff", !stiff.empty()) + obstacles_of(subject, 0, sight) +
               view_of(sight, "page", faces.size() < most_with_edges) + load(plots, "scene.gp"));
}

void expect_drawable(const std::string& path, const Subject& subject, bool motion) {
  const bool png = path.ends_with(".png"), gif = motion && path.ends_with(".gif");
  const auto fail = [](const std::string& what) { throw InputError("--picture", 0, what); };
  if (!png && !gif)
    fail("is '" + path + "', expected a file that ends in .png" +
         (motion ? " (the end) or .gif (the motion)" : ""));
  if (subject.faces().empty() || subject.faces().size() > most_faces)
    fail(text("is for scenes of 1 to %zu faces, expected one, not %zu", most_faces, subject.faces().size()));
  if (!find_program("gnuplot")) fail("needs gnuplot to draw, expected it to be installed (gnuplot-nox)");
  if (!std::filesystem::exists(path) || std::filesystem::is_regular_file(path))
    const OutputFile would_be(path);  // can it be written? Not committed, it is gone
}

void write_picture(const std::string& path, const Subject& subject, double t, const Vector& x) {
  write_drawing(path, drawn_frames(subject, {{t, subject.vertices(x)}}, "white"));
}

Film::Film(const std::string& path, const Subject& subject, double duration)
    : path_(path), subject_(subject), duration_(duration), moves_(path.ends_with(".gif")) {}

void Film::see(double t, const Vector& x) {
  if (!moves_) return;
  while (!frames_.empty() && t < frames_.back().first) frames_.pop_back();
  if (t >= unseen_until()) frames_.emplace_back(t, x);
}

double Film::unseen_until() const {
  return moves_ ? duration_ * static_cast<double>(frames_.size()) / film_frames * (1 - 1e-9)
                : std::numeric_limits<double>::infinity();
}

void Film::write(double t, const Vector& end) const {
  if (path_.empty()) return;
  if (!moves_) return write_picture(path_, subject_, t, end);
  std::vector<Frame> frames;
  for (const auto& [time, x] : frames_) frames.push_back({time, subject_.vertices(x)});
  write_drawing(path_, drawn_frames(subject_, frames, "gif"));
}

std::string matrix_picture(const std::string& plots, const SparseMatrix& matrix) {
  const Eigen::Index side = std::min(matrix.rows(), most_pixels);
  Eigen::ArrayXXi filled = Eigen::ArrayXXi::Zero(side, side);
  for (Eigen::Index k = 0; k < matrix.outerSize(); ++k)
    for (SparseMatrix::InnerIterator entry(matrix, k); entry; ++entry)
      filled(entry.row() * side / matrix.rows(), entry.col() * side / matrix.rows()) = 1;
  std::string rows;
  for (Eigen::Index i = 0; i < side; ++i)
    for (Eigen::Index j = 0; j < side; ++j)
      if (filled(i, j)) rows += text("%ld,%ld\n", static_cast<long>(j), static_cast<long>(i));
  return drawn(gnuplot_data("entries", rows) + setting("side", static_cast<double>(side)) +
               setting("unknowns", static_cast<double>(matrix.rows())) + load(plots, "sparsity.gp"));
}

std::string region_picture(const std::string& plots, const Method& method, const ModesAtStep& first,
                           const std::optional<ModesAtStep>& second) {
  const StabilityRegion& region = stability_region(method);
  std::vector<const ModesAtStep*> all{&first};
  if (second) all.push_back(&*second);
  const Window window = window_for(region, all);
  std::string lines = gnuplot_data("pieces", pieces_of(region, window)) +
                      gnuplot_data("boundary", boundary_of(region, window)) +
                      gnuplot_data("modes_1", modes_of(first)) +
                      gnuplot_data("modes_2", second ? modes_of(*second) : "");
  lines += "method=" + gnuplot_literal(method.info().title) + "\nname_1=" + gnuplot_literal(first.name) +
           "\nname_2=" + gnuplot_literal(second ? second->name : "") + "\n";
  lines += setting("x_min", window.x_min) + setting("x_max", window.x_max) + setting("y_min", window.y_min) +
           setting("y_max", window.y_max);
  lines += setting("has_second", second.has_value()) + setting("is_line", first.modes.is_line);
  return drawn(lines + load(plots, "modes_in_region.gp"));
}

std::string ladder_picture(const std::string& plots, const ContestResult& result) {
  std::string lines, rows;
  int series = 0;
  double least = 0, most = 0;
  for (const ContestSeries& each : result.series) {
    std::string of_it;
    for (const ContestRun& run : each.runs)
      if (run.compared && run.errors->trajectory < 10) {
        const double seconds = run.median_seconds();
        of_it += text("%.6g,%.6g\n", seconds, run.errors->trajectory);
        least = least > 0 ? std::min(least, seconds) : seconds;
        most = std::max(most, seconds);
      }
    if (of_it.empty()) continue;
    lines += text("name_%d=", ++series) + gnuplot_literal(each.contestant.name) + "\n";
    rows += of_it + "\n\n";
  }
  if (series == 0) return {};
  return drawn(gnuplot_data("runs", rows) + lines + setting("series", series) +
               setting("x_min", least / 1.5) + setting("x_max", 1.5 * most) +
               load(plots, "report_ladder.gp"));
}

std::string k0_picture(const std::string& plots, const std::vector<std::pair<double, double>>& points,
                       double safety) {
  std::string rows;
  for (const auto& [time, ratio] : points) rows += text("%.9g,%.9g\n", time, ratio);
  return drawn(gnuplot_data("k0", rows) + setting("safety", safety) + load(plots, "report_k0.gp"));
}

}  // namespace springstab
