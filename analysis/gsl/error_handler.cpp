#include "analysis/gsl/error_handler.h"

#include <gsl/gsl_errno.h>

#include <mutex>

namespace springstab {

void use_error_statuses() {
  static std::once_flag once;
  std::call_once(once, [] { gsl_set_error_handler_off(); });
}

}  // namespace springstab
