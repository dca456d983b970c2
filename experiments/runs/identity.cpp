#include "experiments/runs/identity.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "experiments/runs/fnv1a.h"
#include "experiments/runs/measured_run.h"
#include "solvers/io/input_error.h"

namespace springstab {

Json identity_of(const std::string& command, const Json& options, const Json& inputs) {
  return {{"program", provenance()}, {"command", command}, {"options", options}, {"inputs", inputs}};
}

std::string as_utf8(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string bytes_of(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw InputError(path, 0, "is a folder, expected a file");
  std::ifstream in(path, std::ios::binary);
  std::string all{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw InputError(path, 0, std::string("cannot be read: ") + std::strerror(errno));
  return all;
}

Json contents_of(const std::string& file, bool resume) {
  Json contents{{"name", as_utf8(std::filesystem::path(file).filename().string())}};
  if (!std::filesystem::is_regular_file(file)) {
    if (resume)
      throw InputError(file, 0, "is no regular file, expected one with --resume, to see that it is the same");
    return contents;
  }
  contents["hash"] = hash_of(bytes_of(file));
  if (!is_scene_file(file)) return contents;
  const SceneDescription scene = read_scene_file(file);
  if (const auto* mesh = std::get_if<std::string>(&scene.geometry))
    contents["mesh"] = contents_of(*mesh, resume);
  if (scene.contact)
    for (const MeshObstacleDescription& mesh : scene.contact->meshes)
      contents["obstacles"].push_back(contents_of(mesh.path, resume));
  return contents;
}

Json contents_of(const InputOptions& input, bool resume) {
  Json contents{{"grid", input.grid},
                {"spacing", number(input.spacing)},
                {"material", input.material},
                {"pin", input.pin}};
  const std::pair<const char*, const std::string&> files[] = {{"file", input.file},
                                                              {"stiffness", input.stiffness},
                                                              {"mass", input.mass},
                                                              {"damping-matrix", input.damping_matrix}};
  for (const auto& [name, file] : files) contents[name] = file.empty() ? Json() : contents_of(file, resume);
  if (!input.implicit_damping_matrix.empty())
    contents["implicit-damping-matrix"] = contents_of(input.implicit_damping_matrix, resume);
  if (!input.diagonals.empty()) contents["diagonals"] = input.diagonals;
  if (input.scale) contents["scale"] = number(input.scale);
  const MaterialOptions& numbers = input.numbers;
  if (numbers.area_density) contents["area-density"] = *numbers.area_density;
  if (numbers.mass_total) contents["mass-total"] = *numbers.mass_total;
  if (numbers.stretch) contents["stretch"] = *numbers.stretch;
  if (numbers.bend) contents["bend"] = *numbers.bend;
  if (!input.rayleigh.empty()) contents["rayleigh"] = input.rayleigh;
  if (input.sum_duplicates) contents["sum-duplicates"] = true;
  return contents;
}

void expect_decided(const std::string& path, const EarlierRun& earlier) {
  if (earlier.resume && earlier.overwrite)
    throw InputError("--resume", 0, "stands beside --overwrite, expected one of them");
  std::error_code none;
  const bool asks = !earlier.resume && !earlier.overwrite;
  if (asks && std::filesystem::exists(path, none) && !std::filesystem::is_empty(path, none))
    throw InputError(path, 0,
                     "holds an interrupted run, expected --resume to go on with it or --overwrite to start "
                     "anew");
}

void expect_same_run(const Json& kept, const Json& now, const std::string& path, long line) {
  if (kept == now) return;
  const Json difference = Json::diff(kept, now);
  throw InputError(path, line,
                   "was kept by another run, expected the same " +
                       difference[0]["path"].get<std::string>().substr(1) +
                       "; with --overwrite the run starts anew");
}

}  // namespace springstab
