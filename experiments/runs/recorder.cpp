#include "experiments/runs/recorder.h"

#include <algorithm>
#include <filesystem>

#include "experiments/runs/frames.h"

namespace springstab {

Recorder::Recorder(Subject& subject, const SimulateOptions& options, const Json& kept)
    : subject_(subject), options_(options) {
  if (!kept.is_null()) {
    for (const Json& frame : kept.at("frames")) frames_.push_back({frame[0], frame[1]});
    due_ = kept.at("due");
    most_ = kept.at("most");
    for (int frame = 0; subject.scene() && frame < written(); ++frame)
      expect_frame(options.output, options.format, frame);
  }
  if (options.output.empty() || subject.scene()) return;
  csv_.emplace(options.output + "/trajectory.csv",
               kept.is_null() ? 0 : kept.at("csv_bytes").get<std::uintmax_t>());
  if (!kept.is_null()) return;
  csv_->stream() << "t,kinetic_energy,potential_energy";
  for (Eigen::Index i = 0; i < subject.system().size(); ++i) csv_->stream() << ",x" << i + 1;
  csv_->stream() << '\n';
}

void Recorder::record(double t, const State<Vector>& state) {
  if (options_.output.empty()) return;
  while (!frames_.empty() && t < frames_.back().t) {  // a divergence was undone
    due_ = frames_.back().due;
    frames_.pop_back();
  }
  if (t < next_time()) return;
  if (subject_.scene()) {
    write_frame(options_.output, options_.format, written(), subject_.vertices(state.x), subject_.faces());
  } else {
    csv_->stream() << t << ',' << subject_.system().kinetic_energy(state.v) << ','
                   << subject_.system().potential_energy(state.x);
    for (double x : state.x) csv_->stream() << ',' << x;
    csv_->stream() << '\n';
  }
  frames_.push_back({t, due_});
  most_ = std::max(most_, written());
  while (next_time() <= t && due_ <= options_.frames) ++due_;
}

Json Recorder::kept() {
  Json frames = Json::array();
  for (const Frame& frame : frames_) frames.push_back({frame.t, frame.due});
  return {
      {"frames", frames}, {"due", due_}, {"most", most_}, {"csv_bytes", csv_ ? Json(csv_->keep()) : Json()}};
}

void Recorder::finish() {
  if (csv_) csv_->commit();
  for (int frame = written(); frame < most_; ++frame)  // of what was undone and not reached again
    remove_frame(options_.output, options_.format, frame);
}

std::string Recorder::earlier() const {
  if (options_.output.empty() || !subject_.scene()) return {};
  const std::string path = frame_path(options_.output, options_.format, std::max(most_, written()));
  return std::filesystem::exists(path) ? path : std::string();
}

}  // namespace springstab
