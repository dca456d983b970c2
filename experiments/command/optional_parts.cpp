#include "experiments/command/optional_parts.h"

#include "analysis/proofs/sparse_cholesky.h"
#include "solvers/contact/box_pairs.h"
#include "solvers/io/inflate.h"
#include "solvers/io/xml_file.h"

namespace springstab {

std::vector<OptionalPart> optional_parts() {
#ifdef SPRINGSTAB_ODEINT
  constexpr bool odeint = true;
#else
  constexpr bool odeint = false;
#endif
#ifdef SPRINGSTAB_SUNDIALS
  constexpr bool sundials = true;
#else
  constexpr bool sundials = false;
#endif
  return {{"CHOLMOD, METIS and OpenBLAS", "proofs of large systems", has_cholmod()},
          {"Expat", "VTK's XML files", has_expat()},
          {"zlib", "compressed files", has_zlib()},
          {"Boost.odeint", "work-precision", odeint},
          {"SUNDIALS", "work-precision", sundials},
          {"Embree", "self-contact and mesh obstacles", has_embree()}};
}

std::string optional_parts_text() {
  std::string list;
  for (const OptionalPart& part : optional_parts())
    list += std::string(list.empty() ? "" : ", ") + (part.built_in ? "with " : "without ") + part.name +
            " (for " + part.purpose + ")";
  return list;
}

}  // namespace springstab
