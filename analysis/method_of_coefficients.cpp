#include "analysis/method_of_coefficients.h"

#include "solvers/methods/multistep_method.h"
#include "solvers/methods/tableau_method.h"

namespace springstab {

Method method_of(const MethodName& name, const StageTableau& tableau) {
  if (kind_of(without_idle_stages(tableau)) == StageKind::explicit_stages)
    return make_method(TableauMethod<false>(name.name, name.title, tableau));
  return make_method(TableauMethod<true>(name.name, name.title, tableau));
}

Method method_of(const MethodName& name, const Multistep& formula) {
  if (is_implicit(formula)) return make_method(MultistepMethod<true>(name.name, name.title, formula));
  return make_method(MultistepMethod<false>(name.name, name.title, formula));
}

}  // namespace springstab
