#include "experiments/runs/frames.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>

#include "experiments/command/output.h"
#include "experiments/runs/gltf.h"
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

// Of a number the bytes, the least first.
template <class Number>
void write_bytes(std::ostream& out, Number number) {
  char bytes[sizeof number];
  std::memcpy(bytes, &number, sizeof number);
  if (std::endian::native == std::endian::big) std::reverse(bytes, bytes + sizeof number);
  out.write(bytes, sizeof number);
}

void write_positions(std::ostream& out, const std::vector<Eigen::Vector3d>& positions) {
  for (const Eigen::Vector3d& p : positions)
    for (const double x : p) write_bytes(out, x);
}

void write_ply(std::ostream& out, const std::vector<Eigen::Vector3d>& positions,
               const std::vector<std::vector<int>>& faces) {
  constexpr std::size_t most = 255;  // of a byte
  const bool small = std::ranges::all_of(faces, [](const auto& face) { return face.size() <= most; });
  out << "ply\nformat binary_little_endian 1.0\ncomment springstab\nelement vertex " << positions.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << faces.size()
      << "\nproperty list " << (small ? "uchar" : "uint") << " int vertex_indices\nend_header\n";
  write_positions(out, positions);
  for (const std::vector<int>& face : faces) {
    if (small)
      write_bytes(out, static_cast<std::uint8_t>(face.size()));
    else
      write_bytes(out, static_cast<std::uint32_t>(face.size()));
    for (const int i : face) write_bytes(out, static_cast<std::int32_t>(i));
  }
}

// VTK's XML, with the numbers as they are behind it: each array has its length in bytes before it.
void write_vtp(std::ostream& out, const std::vector<Eigen::Vector3d>& positions,
               const std::vector<std::vector<int>>& faces) {
  std::uint64_t corners = 0;
  for (const std::vector<int>& face : faces) corners += face.size();
  const std::uint64_t bytes_of_positions = 24 * positions.size(), bytes_of_corners = 8 * corners,
                      first_corner = 8 + bytes_of_positions, first_end = first_corner + 8 + bytes_of_corners;
  const auto array = [&](const char* type, const char* name, const char* more, std::uint64_t offset) {
    out << "<DataArray type=\"" << type << "\" Name=\"" << name << '"' << more
        << " format=\"appended\" offset=\"" << offset << "\"/>\n";
  };
  out << "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
         "<PolyData>\n<Piece NumberOfPoints=\""
      << positions.size() << "\" NumberOfPolys=\"" << faces.size() << "\">\n<Points>\n";
  array("Float64", "Points", " NumberOfComponents=\"3\"", 0);
  out << "</Points>\n<Polys>\n";
  array("Int64", "connectivity", "", first_corner);
  array("Int64", "offsets", "", first_end);
  out << "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
  write_bytes(out, bytes_of_positions);
  write_positions(out, positions);
  write_bytes(out, bytes_of_corners);
  for (const std::vector<int>& face : faces)
    for (const int i : face) write_bytes(out, static_cast<std::int64_t>(i));
  write_bytes(out, std::uint64_t{8 * faces.size()});
  std::int64_t end = 0;
  for (const std::vector<int>& face : faces) write_bytes(out, end += static_cast<std::int64_t>(face.size()));
  out << "\n</AppendedData>\n</VTKFile>\n";
}

}  // namespace

std::string frame_path(const std::string& folder, const std::string& format, int frame) {
  const std::string suffix = format == "pvd" ? "vtp" : format == "gltf" ? "bin" : format;
  return folder + text("/frame_%05d.%s", frame, suffix.c_str());
}

void write_series(const std::string& folder, const std::string& format, const std::vector<double>& times,
                  const std::vector<std::vector<int>>& faces) {
  if (format == "gltf") {
    std::vector<std::string> frames;
    for (std::size_t i = 0; i < times.size(); ++i)
      frames.push_back(frame_path(folder, format, static_cast<int>(i)));
    write_gltf(folder, frames, times, faces);
  }
  if (format != "pvd") return;
  OutputFile file(folder + "/frames.pvd");
  file.stream() << "<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
  for (std::size_t frame = 0; frame < times.size(); ++frame)
    file.stream()
        << "<DataSet timestep=\"" << times[frame] << "\" file=\""
        << std::filesystem::path(frame_path(folder, format, static_cast<int>(frame))).filename().string()
        << "\"/>\n";
  file.stream() << "</Collection>\n</VTKFile>\n";
  file.commit();
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
  static const std::map<std::string, decltype(&write_vtk)> writers{
      {"ply", write_ply}, {"pvd", write_vtp}, {"vtk", write_vtk}};
  if (format == "obj")
    write_obj(file.stream(), positions, faces, attributes, source, folder);
  else if (format == "gltf")
    file.stream() << gltf_frame(frame > 0 ? frame_path(folder, format, 0) : "", positions);
  else
    writers.at(format)(file.stream(), positions, faces);
  file.commit();
}

void remove_frame(const std::string& folder, const std::string& format, int frame) {
  std::error_code ignored;
  std::filesystem::remove(frame_path(folder, format, frame), ignored);
}

}  // namespace springstab
