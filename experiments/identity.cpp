#include "experiments/identity.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "experiments/fnv1a.h"
#include "experiments/measured_run.h"
#include "solvers/io/input_error.h"

namespace springstab {

Json identity_of(const std::string& command, const Json& options, const Json& inputs) {
  return {{"program", provenance()}, {"command", command}, {"options", options}, {"inputs", inputs}};
}

std::string as_utf8(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string all{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw InputError(path, 0, std::string("cannot be read: ") + std::strerror(errno));
  return all;
}

Json contents_of(const std::string& file) {
  Json contents{{"name", as_utf8(std::filesystem::path(file).filename().string())}};
  if (!std::filesystem::is_regular_file(file)) return contents;
  contents["hash"] = hash_of(bytes_of(file));
  if (!file.ends_with(".json")) return contents;
  const Geometry geometry = read_scene_file(file).geometry;
  if (const auto* mesh = std::get_if<std::string>(&geometry)) contents["mesh"] = contents_of(*mesh);
  return contents;
}

Json contents_of(const InputOptions& input) {
  Json contents{{"grid", input.grid},
                {"spacing", number(input.spacing)},
                {"material", input.material},
                {"pin", input.pin}};
  const std::pair<const char*, const std::string&> files[] = {{"file", input.file},
                                                              {"stiffness", input.stiffness},
                                                              {"mass", input.mass},
                                                              {"damping-matrix", input.damping_matrix}};
  for (const auto& [name, file] : files) contents[name] = file.empty() ? Json() : contents_of(file);
  return contents;
}

void expect_same_run(const Json& kept, const Json& now, const std::string& path, long line) {
  if (kept == now) return;
  const Json difference = Json::diff(kept, now);
  throw InputError(path, line,
                   "was kept by another run, expected the same " +
                       difference[0]["path"].get<std::string>().substr(1) +
                       "; without --resume the run starts anew");
}

}  // namespace springstab
