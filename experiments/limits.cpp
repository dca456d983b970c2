// `springstab limits`: the largest stable step of each method for a structure, and the damping that goes with
// it.
#include <iostream>

#include "experiments/command/output.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/size_report.h"
#include "experiments/limits_answer.h"
#include "experiments/report/pictures.h"

namespace springstab {

int run_limits(const CommonOptions& common, const LimitsOptions& options) {
  check_limits_options(common, options);
  const std::vector<Method> methods = methods_of(options);
  Subject subject(options.input, true);
  if (options.error) expect_no_contact(subject, "--error");
  print_mesh_notes(subject);
  print_size_warning(subject);
  if (!options.picture.empty()) expect_drawable(options.picture, subject, false);
  LimitsAnswer answer(common, options, methods, subject, !common.json);
  if (!options.picture.empty()) write_picture(options.picture, subject, 0, answer.start().x);
  if (common.json) {
    print_json(answer.json());
  } else {
    std::cout << answer.text_of();
  }
  for (const std::string& remark : answer.remarks()) std::cerr << "springstab: " << remark << '\n';
  return answer.status();
}

}  // namespace springstab
