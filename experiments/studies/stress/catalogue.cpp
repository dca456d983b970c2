#include "experiments/studies/stress/catalogue.h"

#include "experiments/command/enum_name.h"
#include "experiments/command/output.h"
#include "experiments/studies/stress/catalogue_parts.h"

namespace springstab {

void write_text(const std::string& path, const std::string& contents) {
  OutputFile file(path);
  file.stream() << contents;
  file.commit();
}

const char* name(StressOutcome outcome) {
  static constexpr std::pair<StressOutcome, const char*> names[] = {
      {StressOutcome::right, "right"},     {StressOutcome::diverges, "diverges"},
      {StressOutcome::refused, "refused"}, {StressOutcome::no_step, "no step"},
      {StressOutcome::limit, "limit"},     {StressOutcome::wrong, "wrong"}};
  return name_in(names, outcome);
}

StressOutcome Expectation::of(std::string_view method) const {
  for (const auto& [name, other] : but)
    if (name == method) return other;
  return outcome;
}

std::vector<StressCase> stress_catalogue() {
  std::vector<StressCase> all = matrix_cases();
  for (StressCase& more : scene_cases()) all.push_back(std::move(more));
  return all;
}

}  // namespace springstab
