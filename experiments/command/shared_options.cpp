#include "experiments/command/shared_options.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <system_error>

#include "analysis/regions/stability_region.h"
#include "experiments/runs/fnv1a.h"
#include "experiments/runs/identity.h"

namespace springstab {

std::string method_names() {
  std::string names;
  for (const Method& each : methods_of("all")) names += (names.empty() ? "" : ", ") + each.name();
  return names;
}

Option methods_option(std::string& names) {
  return Option("--methods", &names,
                "all, or names with commas, which may have parameters: newmark:beta=0.25,gamma=0.5")
      .shown_as("all|LIST");
}

namespace {

std::vector<Method> methods_named(const std::string& names) {
  if (names.empty()) return all_methods();
  if (names == "all") return built_in_methods();
  // A comma ends a name unless what follows is key=value, a further parameter.
  std::vector<std::string> words;
  std::istringstream list(names);
  for (std::string word; std::getline(list, word, ',');) {
    const bool parameter = word.find(':') == std::string::npos && word.find('=') != std::string::npos;
    if (parameter && !words.empty()) {
      words.back() += "," + word;
    } else {
      words.push_back(word);
    }
  }
  std::vector<Method> methods;
  for (const std::string& word : words) methods.emplace_back(word);
  return methods;
}

}  // namespace

std::vector<Method> methods_of(const std::string& names) {
  std::vector<Method> methods = methods_named(names);
  for (const Method& method : added_methods())
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
  return methods;
}

std::string method_asked_for(const std::string& name, const std::string& option) {
  if (!name.empty()) return name;
  if (added_methods().empty()) throw std::invalid_argument(option + " is required; see springstab --help");
  return added_methods().back().name();
}

Json method_settings(const CommonOptions& common, const std::string& names) {
  Json settings = Json::object();
  if (!names.empty()) settings["methods"] = names;
  if (!common.method_file.empty()) settings["method-file"] = hash_of(bytes_of(common.method_file));
  return settings;
}

bool amplifies_without_need(const Method& method) {
  return method.info().implicit && stability_region(method).amplifies();
}

std::string title_of(const InputOptions& input) {
  return !input.file.empty()   ? std::filesystem::path(input.file).stem().string()
         : !input.grid.empty() ? input.grid
                               : std::filesystem::path(input.stiffness).stem().string();
}

std::vector<Option> with_input(InputOptions& input, std::vector<Option> more) {
  std::vector<Option> all{
      Option(
          "INPUT", &input.file,
          "SCENE.json, a surface .obj, .off, .ply, .stl, .vtp, tetrahedra .veg, or either .msh, .vtk, .vtu")
          .shown_as("FILE"),
      Option("--grid", &input.grid, "N x M particles in the xz-plane; particle i*M + j at (j*s, 0, i*s)")
          .shown_as("NxM"),
      Option("--spacing", &input.spacing, "distance s of the grid's particles (default 0.025)")
          .shown_as("[m]"),
      Option("--diagonals", &input.diagonals, "of a grid of triangles: uniform (default) or alternating")
          .shown_as("WORD")
          .one_of({"uniform", "alternating"}),
      Option("--scale", &input.scale, "of a mesh's or grid's lengths: 0.001 makes millimetres metres")
          .shown_as("S"),
      Option("--material", &input.material, "default, soft, stiff (springs), and for surfaces baraff-witkin")
          .shown_as("NAME"),
      Option("--area-density", &input.numbers.area_density, "of a surface, instead of its material's")
          .shown_as("[kg/m²]"),
      Option("--mass-total", &input.numbers.mass_total, "to which all masses are scaled").shown_as("[kg]"),
      Option("--stretch", &input.numbers.stretch,
             "stiffness of a surface along edges, of triangles along u and v")
          .shown_as("[N/m]"),
      Option("--bend", &input.numbers.bend,
             "stiffness against bending, of springs in N/m, of triangles in N·m")
          .shown_as("[N/m]"),
      Option("--pin", &input.pin,
             "none, first-row, corners, particle numbers like 0,5-9, group:NAME or object:NAME of an OBJ "
             "file, or box:x0:x1,y0:y1,z0:z1 [m]")
          .shown_as("SPEC"),
      Option("--stiffness", &input.stiffness,
             "K: Matrix Market, Harwell- or Rutherford-Boeing, SciPy .npz, PETSc, Abaqus")
          .shown_as("FILE"),
      Option("--mass", &input.mass, "M (default: the unit matrix)").shown_as("FILE"),
      Option("--damping-matrix", &input.damping_matrix, "D (default: none)").shown_as("FILE"),
      Option("--implicit-damping-matrix", &input.implicit_damping_matrix,
             "more of D: what implicit-damping-euler takes implicitly (default: all of D)")
          .shown_as("FILE"),
      Option("--rayleigh", &input.rayleigh, "of matrices: adds d0 M + alpha K to D").shown_as("d0,alpha"),
      Option("--sum-duplicates", &input.sum_duplicates,
             "add up entries of a matrix file that have one position")};
  all.insert(all.end(), std::move_iterator(more.begin()), std::move_iterator(more.end()));
  return all;
}

Option resume_option(EarlierRun& earlier) {
  return Option("--resume", &earlier.resume,
                "go on where the same command was interrupted; what it had finished is in --output");
}

Option overwrite_option(EarlierRun& earlier) {
  return Option("--overwrite", &earlier.overwrite, "start anew where --output holds an interrupted run");
}

std::string plots_folder() {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path here = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const fs::path installed = (here / SPRINGSTAB_INSTALLED_PLOTS).lexically_normal();
  return (fs::is_directory(installed, ignored) ? installed : here / "plots").string();
}

Option plots_option(std::string& plots) {
  plots = plots_folder();
  return Option("--plots", &plots, "folder of the gnuplot scripts").shown_as("DIR").with_default();
}

}  // namespace springstab
