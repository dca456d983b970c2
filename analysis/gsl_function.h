// Lets GSL call a lambda. For .cpp files only.
#pragma once

#include <gsl/gsl_math.h>

namespace springstab {

/// f must outlive the use of the result.
template <class F>
gsl_function as_gsl_function(const F& f) {
  return {[](double t, void* p) { return (*static_cast<const F*>(p))(t); }, const_cast<F*>(&f)};
}

}  // namespace springstab
