// The scenes of the figures about error against run time. A stiff variant has 900 times the soft one's
// springs, and so √k0 30 times as large.
#pragma once

#include "experiments/studies/precision/problem.h"

namespace springstab {

/// x'' = -k x with k = (2π)² 1/s², one period.
Problem oscillator(const CommonOptions& common);
/// 1000 masses of 1 kg between two walls, springs of 1e6 N/m, D = 1/s M + 1e-4 s K, displaced by up to 1 m in
/// a bump at three tenths of its length; for 1 s.
Problem uniform_chain(const CommonOptions& common);
/// The same with springs 1, 11, 21 ... of 1e10 N/m.
Problem stiff_chain(const CommonOptions& common);

/// 32 particles on a string that hangs from the first one and is swung sideways.
Problem hanging_chain(double stiffness_factor, const CommonOptions& common);
/// 11 x 11 particles held at the corners, springs with dampers along them: few enough unknowns for the limit
/// of every method (general_damping.h).
Problem damped_net(double stiffness_factor, const CommonOptions& common);
/// 12 x 12 particles of Baraff's and Witkin's cloth, stretched by a tenth, held all around, struck.
Problem tense_cloth(double stiffness_factor, const CommonOptions& common);
/// 24 x 24 particles let go flat, held by the first row, until it begins to buckle.
Problem spring_drape(const CommonOptions& common);
/// The paper's drape, of Baraff's and Witkin's triangles.
Problem cloth_drape(const CommonOptions& common);
/// The tense cloth of springs, 8 x 8 particles without any damping.
Problem undamped_net(double duration, const CommonOptions& common);

}  // namespace springstab
