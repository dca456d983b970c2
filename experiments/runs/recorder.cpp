#include "experiments/runs/recorder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>

#include "experiments/runs/frames.h"
#include "solvers/io/input_error.h"
#include "solvers/team.h"

namespace springstab {
namespace {

constexpr std::size_t most_last = 32;  // steps

Vector vector_of(const Json& json) {
  const auto numbers = json.get<std::vector<double>>();
  return Vector::Map(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

// Of a file that cannot be read, the hash of what could.
Fnv1a hash_of_file(const std::string& path) {
  Fnv1a hash;
  std::ifstream in(path, std::ios::binary);
  std::vector<char> block(1 << 20);
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0)
    hash.add(block.data(), static_cast<std::size_t>(in.gcount()));
  return hash;
}

}  // namespace

Recorder::Recorder(Subject& subject, const SimulateOptions& options, const Json& kept)
    : subject_(subject), options_(options) {
  if (!kept.is_null()) {
    for (const Json& frame : kept.at("frames"))
      frames_.push_back({frame[0], frame[1], frame[2], Fnv1a(frame[3].get<std::uint64_t>())});
    due_ = kept.at("due");
    most_ = kept.at("most");
    for (int frame = 0; subject.scene() && frame < written(); ++frame)
      expect_frame(options.output, options.format, frame);
    on_disk_ = written();
    for (const Json& moment : kept.value("last", Json::array()))
      last_.push_back({moment[0], {vector_of(moment[1]), vector_of(moment[2])}});
  }
  if (options.output.empty()) return;
  const std::string path = options.output + (subject.scene() ? "/energy.csv" : "/trajectory.csv");
  csv_bytes_ = kept.is_null() ? 0 : kept.at("csv_bytes").get<std::uintmax_t>();
  csv_.emplace(path, csv_bytes_);
  if (!kept.is_null()) {
    csv_hash_ = hash_of_file(OutputFile::kept_path(path));
    if (csv_hash_.hex() != kept.at("csv_hash"))
      throw InputError(OutputFile::kept_path(path), 0, OutputFile::not_what_was_kept);
    return;
  }
  std::string names = "t,kinetic_energy,potential_energy";
  for (Eigen::Index i = 0; !subject.scene() && i < subject.system().size(); ++i)
    names += ",x" + std::to_string(i + 1);
  write_row(names);
}

void Recorder::write_row(const std::string& row) {
  csv_->stream() << row << '\n';
  csv_hash_.add(row);
  csv_hash_.add("\n");
  csv_bytes_ += row.size() + 1;
}

void Recorder::record(double t, const State<Vector>& state) {
  if (options_.output.empty()) return;
  if (keeps_last()) remember(t, state);
  while (!frames_.empty() && t < frames_.back().t) take_back_last();  // a divergence was undone
  if (t < next_time()) return;
  write(t, state);
  while (next_time() <= t && due_ <= options_.frames) ++due_;
}

double Recorder::unseen_until() const {
  constexpr double forever = std::numeric_limits<double>::infinity();
  return options_.output.empty() ? forever : keeps_last() ? -forever : next_time();
}

void Recorder::take_back_last() {
  const Frame& last = frames_.back();
  csv_->cut(last.begin);
  csv_bytes_ = last.begin;
  csv_hash_ = last.before;
  due_ = last.due;
  frames_.pop_back();
  on_disk_ = std::min(on_disk_, written());
}

void Recorder::remember(double t, const State<Vector>& state) {
  while (!last_.empty() && t <= last_.back().t) last_.pop_back();  // a divergence was undone
  Moment moment;
  if (last_.size() == most_last) {  // into the memory it has
    moment = std::move(last_.front());
    last_.pop_front();
  }
  moment.t = t;
  moment.state.x = state.x;
  moment.state.v = state.v;
  last_.push_back(std::move(moment));
}

void Recorder::record_last() {
  if (last_.empty()) return;
  while (!frames_.empty() && frames_.back().t >= last_.front().t) take_back_last();
  for (const auto& [t, state] : last_) write(t, state);
  last_steps_ = static_cast<int>(last_.size());
}

void Recorder::write(double t, const State<Vector>& state) {
  frames_.push_back({t, due_, csv_bytes_, csv_hash_});
  if (subject_.scene()) {
    wait_for_frame();
    auto save = [this, frame = written() - 1, positions = subject_.vertices(state.x)] {
      const std::optional<MeshFile>& file = subject_.mesh_file();
      write_frame(options_.output, options_.format, frame, positions, subject_.faces(),
                  file ? file->attributes : FaceAttributes(), file ? file->path : std::string());
    };
    if (loop_threads() > 1) {
      writing_ = std::async(std::launch::async, std::move(save));
    } else {
      save();
    }
  }
  std::string row = text("%.17g,%.17g,%.17g", t, subject_.system().kinetic_energy(state.v),
                         subject_.system().potential_energy(state.x));
  for (Eigen::Index i = 0; !subject_.scene() && i < state.x.size(); ++i) row += text(",%.17g", state.x[i]);
  write_row(row);
  most_ = std::max(most_, written());
}

void Recorder::wait_for_frame() {
  if (writing_.valid()) writing_.get();
}

void Recorder::write_times() {
  if (options_.output.empty() || !subject_.scene()) return;
  std::vector<double> times;
  for (const Frame& frame : frames_) times.push_back(frame.t);
  write_series(options_.output, options_.format, times, subject_.faces());
}

void Recorder::flush() {
  wait_for_frame();
  if (csv_) csv_->keep();
}

Json Recorder::kept() {
  wait_for_frame();
  Json frames = Json::array();
  for (const Frame& frame : frames_)
    frames.push_back({frame.t, frame.due, frame.begin, frame.before.value()});
  Json kept{{"frames", frames}, {"due", due_}, {"most", most_}};
  if (csv_) kept.update({{"csv_bytes", csv_->keep_on_disk()}, {"csv_hash", csv_hash_.hex()}});
  for (; subject_.scene() && on_disk_ < written(); ++on_disk_)
    sync_file(frame_path(options_.output, options_.format, on_disk_));
  if (options_.format == "pvd") write_times();  // glTF's would read all frames
  sync_folder(options_.output);
  for (const auto& [t, state] : last_)
    kept["last"].push_back({t, std::vector<double>(state.x.begin(), state.x.end()),
                            std::vector<double>(state.v.begin(), state.v.end())});
  return kept;
}

void Recorder::finish() {
  wait_for_frame();
  if (csv_) csv_->commit();
  write_times();
  for (int frame = written(); frame < most_; ++frame)  // of what was undone and not reached again
    remove_frame(options_.output, options_.format, frame);
}

std::string Recorder::earlier() const {
  if (options_.output.empty() || !subject_.scene()) return {};
  const std::string path = frame_path(options_.output, options_.format, std::max(most_, written()));
  return std::filesystem::exists(path) ? path : std::string();
}

}  // namespace springstab
