#include "experiments/runs/checkpoint.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "experiments/runs/fnv1a.h"
#include "experiments/runs/identity.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr std::chrono::milliseconds least_interval{200};
constexpr int saving_share = 100;  // of the time that saving takes, between savings
constexpr std::size_t hash_digits = 16;

Json json_of(const RunSoFar& run) {
  Json stages = Json::array();
  for (const Stage& s : run.stages)
    stages.push_back({s.start, s.plan.h, s.plan.steps, s.plan.steps_per_linearization, s.done});
  return {{"steps", run.steps},
          {"time", run.time},
          {"failed_at", run.failed_at},
          {"failures", run.failures},
          {"stages", stages}};
}

RunSoFar run_of(const Json& json) {
  RunSoFar run;
  run.steps = json.at("steps");
  run.time = json.at("time");
  run.failed_at = json.at("failed_at");
  run.failures = json.at("failures");
  for (const Json& s : json.at("stages")) run.stages.push_back({s[0], {s[1], s[2], s[3]}, s[4]});
  return run;
}

// In the order in which they are stored.
template <class AnyState,
          class AnyVector = std::conditional_t<std::is_const_v<AnyState>, const Vector, Vector>>
std::vector<AnyVector*> vectors_of(AnyState& state) {
  std::vector<AnyVector*> all{&state.x, &state.v};
  for (AnyVector& u : state.memory) all.push_back(&u);
  return all;
}

}  // namespace

CheckpointFile::CheckpointFile(const std::string& folder, const Json& identity, const EarlierRun& earlier,
                               bool quiet)
    : identity_(identity), due_(Clock::now() + least_interval) {
  if (folder.empty()) return;
  lock_.emplace(folder);
  path_ = folder + "/simulate.checkpoint";
  expect_decided(path_, earlier);
  if (!earlier.resume) {
    finish();
    sync_folder(folder);  // lest it comes back beside the frames of this run
  } else if (!quiet && !std::filesystem::exists(path_)) {
    std::cerr << "springstab: nothing was kept in " << path_ << ", starting anew\n";
  }
}

std::optional<KeptRun> CheckpointFile::read() {
  if (path_.empty() || !std::filesystem::exists(path_)) return std::nullopt;
  const std::string all = bytes_of(path_);
  const InputError damaged(path_, 0,
                           "is damaged, expected a whole checkpoint; with --overwrite the run starts anew");
  if (all.size() < hash_digits) throw damaged;
  const std::string_view content = std::string_view(all).substr(0, all.size() - hash_digits);
  const std::size_t end = content.find('\n');
  if (hash_of(content) != std::string_view(all).substr(content.size()) || end == std::string_view::npos)
    throw damaged;
  const Json about = Json::parse(content.substr(0, end));
  expect_same_run(about.at("identity"), identity_, path_, 0);
  KeptRun kept{run_of(about.at("run")), {}, about.at("others")};
  const Eigen::Index size = about.at("unknowns");
  kept.state.memory.resize(about.value("memory", std::size_t{0}));
  const char* next = content.data() + end + 1;
  for (Vector* u : vectors_of(kept.state)) {
    u->resize(size);
    const std::size_t bytes = sizeof(double) * static_cast<std::size_t>(size);
    std::memcpy(u->data(), next, bytes);
    next += bytes;
  }
  saved_until_ = kept.run.time;
  return kept;
}

void CheckpointFile::save(const std::function<KeptRun()>& make) {
  if (path_.empty()) return;
  const Clock::time_point before = Clock::now();
  const KeptRun kept = make();
  const std::vector<const Vector*> vectors = vectors_of(kept.state);
  if (!std::all_of(vectors.begin(), vectors.end(), [](const Vector* u) { return u->allFinite(); }) ||
      !all_finite(kept.others))
    throw std::logic_error("a state to be saved is not finite");
  Json about{{"identity", identity_},
             {"unknowns", kept.state.x.size()},
             {"run", json_of(kept.run)},
             {"others", kept.others}};
  if (!kept.state.memory.empty()) about["memory"] = kept.state.memory.size();
  std::string content = about.dump() + '\n';
  for (const Vector* u : vectors)
    content.append(reinterpret_cast<const char*>(u->data()),
                   sizeof(double) * static_cast<std::size_t>(u->size()));
  OutputFile file(path_);
  file.stream() << content << hash_of(content);
  file.commit_to_disk();
  saved_until_ = kept.run.time;
  const Clock::time_point after = Clock::now();
  due_ = after + std::max<Clock::duration>(least_interval, saving_share * (after - before));
}

void CheckpointFile::finish() const {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove(path_, ignored);
}

}  // namespace springstab
