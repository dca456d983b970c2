#include "experiments/inputs/mesh_report.h"

#include <iostream>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

// "merged 2 vertices, dropped 1 face": what there is none of is left out.
class Counted {
 public:
  void add(int count, const char* what, const std::string& one, const std::string& many) {
    if (count > 0)
      list_ += (list_.empty() ? "" : ", ") + text("%s%d %s", what, count, (count == 1 ? one : many).c_str());
  }
  const std::string& list() const { return list_; }

 private:
  std::string list_;
};

class Notes {
 public:
  void say(const std::string& kind, const std::string& source, const std::string& what, long line = 0) {
    all_.push_back(kind + ": " + place_of(source, line) + what);
  }
  void note(const MeshFile& file, const std::string& what, long line = 0) {
    say("note", file.path, what, line);
  }
  void add(const std::vector<std::string>& more) {
    for (const std::string& each : more) all_.push_back("note: " + each);
  }
  const std::vector<std::string>& all() const { return all_; }

 private:
  std::vector<std::string> all_;
};

void add_texture_notes(const MeshFile& file, Notes& notes) {
  if (!file.texture_map) return;
  const TextureMap& map = *file.texture_map;
  if (file.rest_shape != RestShape::texture)
    return notes.note(
        file, "this face has no area in the texture map, which is not used: all faces rest as they lie",
        map.line);
  if (map.strained == 0) return;
  const std::string scale =
      map.unit == map.area_unit
          ? text("though the map has the mesh's area (texture_unit %.4g m)", map.unit)
          : text("at a texture_unit of %.4g m; the mesh's area asks for %.4g m", map.unit, map.area_unit);
  notes.say(
      "warning", file.path,
      text("the cloth starts strained: %d of %d triangles differ from the texture map by more than a factor "
           "of %g in length, this face by %.4g, ",
           map.strained, map.triangles, straining_factor, map.largest_factor) +
          scale + "; without texture coordinates (vt) faces rest as they lie",
      map.line);
}

void add_unused_texture_unit(const Subject& subject, Notes& notes) {
  if (!subject.material()) return;
  const auto* cloth = std::get_if<ClothMaterial>(&*subject.material());
  const std::optional<MeshFile>& file = subject.mesh_file();
  if (cloth && cloth->texture_unit && !(file && file->rest_shape == RestShape::texture))
    notes.say("note", "texture_unit", "is not used: the cloth rests as it lies, not by a texture map");
}

// Null where there is none, in a plane, and for springs; of one that is not used the line alone.
Json texture_json(const MeshFile& file) {
  if (!file.texture_map) return nullptr;
  const TextureMap& map = *file.texture_map;
  const Json line = map.line > 0 ? Json(map.line) : Json();  // a binary file has none
  if (file.rest_shape != RestShape::texture) return {{"used", false}, {"line", line}};
  return {{"used", true},
          {"line", line},
          {"texture_unit", number(map.unit)},
          {"area_unit", number(map.area_unit)},
          {"triangles", map.triangles},
          {"strained_triangles", map.strained},
          {"largest_factor", number(map.largest_factor)}};
}

}  // namespace

std::vector<std::string> mesh_notes(const Subject& subject) {
  Notes notes;
  add_unused_texture_unit(subject, notes);
  notes.add(subject.contact_notes());
  if (subject.has_unused_diagonals())
    notes.say("note", "diagonals", "have no use here: springs lie on both diagonals of a cell");
  if (!subject.mesh_file()) return notes.all();
  const MeshFile& file = *subject.mesh_file();
  const MeshRepair& r = file.repair;
  for (const FileNote& n : file.notes) notes.note(file, n.text, n.line);
  const std::string one = file.solid ? "tetrahedron" : "face", many = file.solid ? "tetrahedra" : "faces";
  Counted mended;
  mended.add(r.merged_vertices, "merged ", "duplicate vertex", "duplicate vertices");
  mended.add(r.shortened_elements, "shortened ", "face with a repeated corner",
             "faces with a repeated corner");
  mended.add(r.degenerate_elements, "dropped ", "degenerate " + one, "degenerate " + many);
  mended.add(r.duplicate_elements, "dropped ", "duplicate " + one, "duplicate " + many);
  mended.add(r.unreferenced_vertices, "dropped ", "unreferenced vertex", "unreferenced vertices");
  mended.add(r.turned_elements, "turned ", "left-handed tetrahedron", "left-handed tetrahedra");
  if (r.changed()) notes.note(file, mended.list() + "; pins and frames keep the numbers of the file");
  if (r.crowded > 0 && file.solid)
    notes.note(file, text("%d %s tetrahedra that overlap: more than two, or two on one side", r.crowded,
                          r.crowded == 1 ? "face has" : "faces have"));
  if (r.crowded > 0 && !file.solid)
    notes.note(file, text("%d %s more than two faces: every two of them resist bending there", r.crowded,
                          r.crowded == 1 ? "edge has" : "edges have"));
  add_texture_notes(file, notes);
  return notes.all();
}

void print_mesh_notes(const Subject& subject) {
  for (const std::string& note : mesh_notes(subject)) std::cerr << "springstab: " << note << '\n';
}

Json mesh_json(const Subject& subject) {
  if (!subject.mesh_file()) return nullptr;
  const MeshFile& file = *subject.mesh_file();
  const MeshRepair& r = file.repair;
  Json json{{"vertices", file.vertices.size()},
            {"merged_vertices", r.merged_vertices},
            {"unreferenced_vertices", r.unreferenced_vertices}};
  if (file.solid) {
    json["degenerate_tetrahedra"] = r.degenerate_elements;
    json["duplicate_tetrahedra"] = r.duplicate_elements;
    json["left_handed_tetrahedra"] = r.turned_elements;
    json["overlapped_faces"] = r.crowded;
  } else {
    json["shortened_faces"] = r.shortened_elements;
    json["degenerate_faces"] = r.degenerate_elements;
    json["duplicate_faces"] = r.duplicate_elements;
    json["non_manifold_edges"] = r.crowded;
    json["texture_map"] = texture_json(file);
  }
  return json;
}

}  // namespace springstab
