// The page that `springstab report` writes, told section by section from one answer of `limits`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/limits_answer.h"
#include "experiments/report/page.h"

namespace springstab {

struct ReportOptions {
  LimitsOptions limits;            // for_step is the user's step
  std::optional<double> duration;  // of the motions [s]
  std::string output, pdf, plots;
};

/// Said once where gnuplot is missing.
inline constexpr char without_pictures[] =
    "there are no pictures: gnuplot was not found (the package gnuplot-nox)";

class ReportPage {
 public:
  /// Computes what it tells beyond `answer`, which has to be a measured one. All must outlive it.
  ReportPage(const CommonOptions& common, const ReportOptions& options, LimitsAnswer& answer,
             const std::vector<std::string>& remarks);

  std::string html() { return page_.text(); }

 private:
  const LimitsRow* best_row() const;
  std::string sentence() const;
  std::string on_wanted_step() const;
  std::vector<std::vector<long>> stiffest_elements() const;
  std::string input_text() const;
  std::string damping_text() const;
  std::vector<std::vector<std::string>> limits_rows() const;
  std::vector<const LimitsRow*> recommended() const;
  std::string region_figure(const LimitsRow& row, const std::string& id, bool& is_line,
                            std::string& left_out);
  void add_scene();
  void add_picture();
  void add_limits();
  void add_regions();
  void add_ladder();
  void add_motion();
  void add_stiffest();
  void add_command();

  const CommonOptions& common_;
  const ReportOptions& options_;
  LimitsAnswer& answer_;
  Json limits_;            // what `limits --json` prints
  bool draws_;             // gnuplot is there
  const LimitsRow* best_;  // null where no step is known
  Page page_;
};

}  // namespace springstab
