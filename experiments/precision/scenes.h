// The scenes of the figures about error against run time.
#pragma once

#include "experiments/precision/problem.h"

namespace springstab {

/// 1000 masses of 1 kg between two walls, springs of 1e6 N/m, Rayleigh damping of 1e-4 s, displaced by 1 m in
/// a bump at three tenths of its length; for 1 s.
Problem uniform_chain(const CommonOptions& common);
/// The same with springs 1, 11, 21 ... of 1e10 N/m.
Problem stiff_chain(const CommonOptions& common);
/// x'' = -k x with k = (2π)² 1/s², one period.
Problem oscillator(const CommonOptions& common);

}  // namespace springstab
