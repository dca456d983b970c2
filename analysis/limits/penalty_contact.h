// Limits with contact by springs k_c and dampers d_c (solvers/contact/penalty.h): with at most c fixed
// obstacles at a particle, in every contact state
//     K_contact ⪯ K + c k_c,   D_contact ⪯ D + c d_c + α c k_c,
// and symplectic Euler's limit falls monotonically when K or D grows. Contact between surfaces adds twice
// that while its normals and weights stay (solvers/contact/surface_penalty.h).
#pragma once

#include "analysis/limits/structure.h"

namespace springstab {

struct ContactBound {
  double stiffness = 0, damping = 0;  // c k_c [N/m], c d_c [N·s/m]
};

/// What no contact state exceeds, of matrices without contact; `alpha` is that of D = ... + αK where D is all
/// there.
StructuralMatrices in_any_contact(StructuralMatrices s, const ContactBound& bound, double alpha);

/// The same of a structure. Where two numbers say its damping, they still do, and the bound must have no
/// damping of its own.
Structure in_any_contact(Structure structure, const ContactBound& bound);

}  // namespace springstab
