// The pictures of a report, by gnuplot: the scene, modes in the regions of methods, error against run time,
// k0 along a motion.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/regions/stability_region.h"
#include "analysis/spectra/numerical_range.h"
#include "experiments/inputs/subject.h"
#include "experiments/studies/precision/contest.h"

namespace springstab {

/// The scene in a state at its start as a PNG without background, with the obstacles there are; pinned
/// particles and the particles of the stiffest elements are marked. Empty where there are no faces or too
/// many to draw.
std::string scene_picture(const std::string& plots, const Subject& subject, const Vector& x,
                          const std::vector<std::vector<long>>& stiffest);

/// Throws InputError unless there are gnuplot, its scripts and faces, and `path` ends in .png, or where a
/// `motion` is to be seen in .gif.
void expect_drawable(const std::string& path, const Subject& subject, bool motion);
/// The scene in a state at the time t [s], with the obstacles then, on white, into a PNG file.
void write_picture(const std::string& path, const Subject& subject, double t, const Vector& x);

/// A quick look at a run of `duration` [s]: its end as PNG, or its motion as GIF. Nothing where `path` is
/// empty.
class Film {
 public:
  /// `subject` must outlive it.
  Film(const std::string& path, const Subject& subject, double duration);
  /// What lies after t is forgotten first: a divergence was undone.
  void see(double t, const Vector& x);
  /// Before that time it has no use for states [s].
  double unseen_until() const;
  /// Throws InputError if it cannot be written.
  void write(double t, const Vector& end) const;

 private:
  std::string path_;
  const Subject& subject_;
  double duration_;
  bool moves_;
  std::vector<std::pair<double, Vector>> frames_;  // time [s], x
};

/// What is not zero of a matrix, as a PNG without background.
std::string matrix_picture(const std::string& plots, const SparseMatrix& matrix);

/// All modes of a structure, from which those of any step follow: X = hd, Y = h²k.
struct ModeShape {
  std::vector<ModePoint> outline;  // of a convex set that holds them; of a line its two ends
  bool is_line = true;
};

/// The modes at a step, and what that step is called.
struct ModesAtStep {
  double h;  // [s]
  std::string name;
  ModeShape modes;
};

/// SVG. `second` is the user's step.
std::string region_picture(const std::string& plots, const Method& method, const ModesAtStep& first,
                           const std::optional<ModesAtStep>& second);

/// SVG.
std::string ladder_picture(const std::string& plots, const ContestResult& result);

/// SVG. Points are (time [s], k0 at that time over k0 at the start).
std::string k0_picture(const std::string& plots, const std::vector<std::pair<double, double>>& points,
                       double safety);

}  // namespace springstab
