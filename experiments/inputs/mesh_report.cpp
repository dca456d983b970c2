#include "experiments/inputs/mesh_report.h"

#include <iostream>

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

void say(const std::string& kind, const std::string& place, const std::string& what) {
  std::cerr << "springstab: " << kind << ": " << place << ": " << what << '\n';
}

void note(const MeshFile& file, const std::string& what) { say("note", file.path, what); }

void print_texture_notes(const MeshFile& file) {
  if (!file.texture_map) return;
  const TextureMap& map = *file.texture_map;
  const std::string face = file.path + ':' + std::to_string(map.line);
  if (file.rest_shape != RestShape::texture)
    return say("note", face,
               "this face has no area in the texture map, which is not used: all faces rest as they lie");
  if (map.strained == 0) return;
  const std::string scale =
      map.unit == map.area_unit
          ? text("though the map has the mesh's area (texture_unit %.4g m)", map.unit)
          : text("at a texture_unit of %.4g m; the mesh's area asks for %.4g m", map.unit, map.area_unit);
  say("warning", face,
      text("the cloth starts strained: %d of %d triangles differ from the texture map by more than a factor "
           "of %g in length, this face by %.4g, ",
           map.strained, map.triangles, straining_factor, map.largest_factor) +
          scale + "; without texture coordinates (vt) faces rest as they lie");
}

void print_unused_texture_unit(const Subject& subject) {
  if (!subject.material()) return;
  const auto* cloth = std::get_if<ClothMaterial>(&*subject.material());
  const std::optional<MeshFile>& file = subject.mesh_file();
  if (cloth && cloth->texture_unit && !(file && file->rest_shape == RestShape::texture))
    say("note", "texture_unit", "is not used: the cloth rests as it lies, not by a texture map");
}

// Null where there is none, in a plane, and for springs; of one that is not used the line alone.
Json texture_json(const MeshFile& file) {
  if (!file.texture_map) return nullptr;
  const TextureMap& map = *file.texture_map;
  if (file.rest_shape != RestShape::texture) return {{"used", false}, {"line", map.line}};
  return {{"used", true},
          {"line", map.line},
          {"texture_unit", number(map.unit)},
          {"area_unit", number(map.area_unit)},
          {"triangles", map.triangles},
          {"strained_triangles", map.strained},
          {"largest_factor", number(map.largest_factor)}};
}

}  // namespace

void print_mesh_notes(const Subject& subject) {
  print_unused_texture_unit(subject);
  for (const std::string& contact_note : subject.contact_notes())
    std::cerr << "springstab: note: " << contact_note << '\n';
  if (subject.has_unused_diagonals())
    say("note", "diagonals", "have no use here: springs lie on both diagonals of a cell");
  if (!subject.mesh_file()) return;
  const MeshFile& file = *subject.mesh_file();
  const MeshRepair& r = file.repair;
  for (const FileNote& n : file.notes) say("note", file.path + ':' + std::to_string(n.line), n.text);
  const std::string one = file.solid ? "tetrahedron" : "face", many = file.solid ? "tetrahedra" : "faces";
  Counted mended;
  mended.add(r.merged_vertices, "merged ", "duplicate vertex", "duplicate vertices");
  mended.add(r.shortened_elements, "shortened ", "face with a repeated corner",
             "faces with a repeated corner");
  mended.add(r.degenerate_elements, "dropped ", "degenerate " + one, "degenerate " + many);
  mended.add(r.duplicate_elements, "dropped ", "duplicate " + one, "duplicate " + many);
  mended.add(r.unreferenced_vertices, "dropped ", "unreferenced vertex", "unreferenced vertices");
  mended.add(r.turned_elements, "turned ", "left-handed tetrahedron", "left-handed tetrahedra");
  if (r.changed()) note(file, mended.list() + "; pins and frames keep the numbers of the file");
  if (r.crowded > 0 && file.solid)
    note(file, text("%d %s tetrahedra that overlap: more than two, or two on one side", r.crowded,
                    r.crowded == 1 ? "face has" : "faces have"));
  if (r.crowded > 0 && !file.solid)
    note(file, text("%d %s more than two faces: every two of them resist bending there", r.crowded,
                    r.crowded == 1 ? "edge has" : "edges have"));
  print_texture_notes(file);
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
