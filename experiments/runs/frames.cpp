#include "experiments/runs/frames.h"

#include <filesystem>

#include "experiments/command/output.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

// A library of materials is named relative to the file that names it.
std::string from_folder(const std::string& words, const std::string& source, const std::string& folder) {
  namespace fs = std::filesystem;
  const fs::path library(words);
  if (library.is_absolute()) return words;
  return fs::proximate(fs::path(source).parent_path() / library, folder).generic_string();
}

void write_obj(std::ostream& out, const std::vector<Eigen::Vector3d>& positions,
               const std::vector<std::vector<int>>& faces, const FaceAttributes& attributes,
               const std::string& source, const std::string& folder) {
  for (const Eigen::Vector3d& p : positions) out << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  for (const Eigen::Vector2d& t : attributes.textures) out << "vt " << t.x() << ' ' << t.y() << '\n';
  auto statement = attributes.statements.begin();
  auto texture = attributes.corner_textures.begin();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (; statement != attributes.statements.end() && statement->face <= static_cast<int>(f); ++statement) {
      const bool library = statement->keyword == "mtllib";
      out << statement->keyword << ' '
          << (library ? from_folder(statement->words, source, folder) : statement->words) << '\n';
    }
    out << 'f';
    for (int i : faces[f]) {
      out << ' ' << i + 1;
      if (texture != attributes.corner_textures.end() && *texture++ >= 0) out << '/' << texture[-1] + 1;
    }
    out << '\n';
  }
}

void write_vtk(std::ostream& out, const std::vector<Eigen::Vector3d>& positions,
               const std::vector<std::vector<int>>& faces) {
  out << "# vtk DataFile Version 3.0\nspringstab\nASCII\nDATASET POLYDATA\nPOINTS " << positions.size()
      << " double\n";
  for (const Eigen::Vector3d& p : positions) out << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  std::size_t numbers = 0;
  for (const std::vector<int>& face : faces) numbers += face.size() + 1;
  out << "POLYGONS " << faces.size() << ' ' << numbers << '\n';
  for (const std::vector<int>& face : faces) {
    out << face.size();
    for (int i : face) out << ' ' << i;
    out << '\n';
  }
}

}  // namespace

std::string frame_path(const std::string& folder, const std::string& format, int frame) {
  return folder + text("/frame_%05d.%s", frame, format.c_str());
}

void expect_frame(const std::string& folder, const std::string& format, int frame) {
  const std::string path = frame_path(folder, format, frame);
  if (!std::filesystem::exists(path))
    throw InputError(path, 0, "is missing, expected all frames of the run; with --overwrite it starts anew");
}

void write_frame(const std::string& folder, const std::string& format, int frame,
                 const std::vector<Eigen::Vector3d>& positions, const std::vector<std::vector<int>>& faces,
                 const FaceAttributes& attributes, const std::string& source) {
  OutputFile file(frame_path(folder, format, frame));
  if (format == "vtk")
    write_vtk(file.stream(), positions, faces);
  else
    write_obj(file.stream(), positions, faces, attributes, source, folder);
  file.commit();
}

void remove_frame(const std::string& folder, const std::string& format, int frame) {
  std::error_code ignored;
  std::filesystem::remove(frame_path(folder, format, frame), ignored);
}

}  // namespace springstab
