#include "solvers/io/vtk_xml.h"

#include <array>
#include <utility>

#include "solvers/io/vtk_arrays.h"
#include "solvers/io/vtk_cells.h"

namespace springstab {
namespace {

class VtkXmlReader {
 public:
  VtkXmlReader(const std::string& source, std::string_view text) : arrays_(source, text), builder_(source) {}

  AnyMesh read() {
    const std::vector<XmlElement>& all = arrays_.xml().elements;
    const std::string_view kind = all.front().attribute("type");
    const bool poly_data = kind == "PolyData";
    if (!poly_data && kind != "UnstructuredGrid")
      all.front().at.fail("the data are " + quoted(kind) + ", expected PolyData or UnstructuredGrid");
    for (int e = 0; e < static_cast<int>(all.size()); ++e)
      if (all[e].name == "Piece") piece(e, poly_data);
    return std::move(builder_).finish("cells of types 5 to 10");
  }

 private:
  /// The elements within another one: of that name, and if it is not empty with that attribute Name.
  const XmlElement* child(int parent, std::string_view element, std::string_view name = "") const {
    for (const XmlElement& e : arrays_.xml().elements)
      if (e.parent == parent && e.name == element && (name.empty() || e.attribute("Name") == name)) return &e;
    return nullptr;
  }
  int index_of(const XmlElement& element) const {
    return static_cast<int>(&element - arrays_.xml().elements.data());
  }

  const XmlElement& array(const XmlElement& section, std::string_view name) const {
    const XmlElement* const found = child(index_of(section), "DataArray", name);
    if (!found)
      section.at.fail(springstab::quoted(section.name) + " has no DataArray" +
                      (name.empty() ? "" : " of the name " + std::string(name)) + ", expected one");
    return *found;
  }

  static long long count(const XmlElement& piece, const std::string& key) {
    return count_of(piece.at, piece.attribute(key, "0"), key);
  }

  void piece(int number, bool poly_data) {
    const XmlElement& piece = arrays_.xml().elements[static_cast<std::size_t>(number)];
    points_ = count(piece, "NumberOfPoints");
    if (points_ > 0) {
      const XmlElement* const section = child(number, "Points");
      if (!section) piece.at.fail("the piece has no Points, expected them");
      points(array(*section, ""));
    }
    if (poly_data) {
      constexpr std::array<std::pair<const char*, int>, 4> kinds{{{"Verts", vtk_poly_vertex},
                                                                  {"Lines", vtk_poly_line},
                                                                  {"Strips", vtk_strip},
                                                                  {"Polys", vtk_polygon}}};
      for (const auto& [name, type] : kinds) section(piece, name, "NumberOf" + std::string(name), type);
    } else {
      section(piece, "Cells", "NumberOfCells", -1);
    }
    before_ += points_;
  }

  void points(const XmlElement& array) {
    if (array.attribute("NumberOfComponents", "1") != "3")
      array.at.fail("points of " + quoted(array.attribute("NumberOfComponents", "1")) +
                    " components, expected 3");
    const VtkArray<double> x = arrays_.reals(array);
    check_count(array.at, "coordinates", static_cast<long long>(x.values.size()), 3 * points_);
    for (std::size_t i = 0; i < x.values.size(); i += 3)
      builder_.add_vertex(before_ + static_cast<long long>(i / 3),
                          {x.values[i], x.values[i + 1], x.values[i + 2]}, x.place(i));
  }

  /// Cells of one type, or of those that the section tells.
  void section(const XmlElement& piece, const std::string& name, const std::string& key, int type) {
    const long long cells = count(piece, key);
    if (cells == 0) return;
    const XmlElement* const section = child(index_of(piece), name);
    if (!section) piece.at.fail("the piece has no " + name + ", expected them");
    const XmlElement &corner_array = array(*section, "connectivity"), &end_array = array(*section, "offsets");
    const VtkArray<long long> corners = arrays_.integers(corner_array), ends = arrays_.integers(end_array);
    check_count(end_array.at, "offsets", static_cast<long long>(ends.values.size()), cells);
    VtkArray<long long> types{std::vector<long long>(ends.values.size(), type), {section->at}};
    if (type < 0) types = arrays_.integers(array(*section, "types"));
    check_count(types.at.front(), "types", static_cast<long long>(types.values.size()), cells);
    std::size_t begin = 0;
    for (std::size_t c = 0; c < ends.values.size(); ++c) {
      const long long end = ends.values[c];
      if (end < static_cast<long long>(begin) || end > static_cast<long long>(corners.values.size()))
        ends.place(c).fail("the offset " + std::to_string(end) + " of cell " + std::to_string(c) +
                           " is out of order, expected " + std::to_string(begin) + " to " +
                           std::to_string(corners.values.size()));
      const auto count = static_cast<std::size_t>(end) - begin;
      const Location at = count > 0 ? corners.place(begin) : end_array.at;
      check_vtk_cell(types.values[c], static_cast<long long>(count), types.place(c), at);
      add_vtk_cell(builder_, types.values[c], numbered({corners.values.data() + begin, count}, c, at), at);
      begin += count;
    }
  }

  /// The numbers of a cell's points in the whole file.
  std::span<const long long> numbered(std::span<const long long> corners, std::size_t cell,
                                      const Location& at) {
    corners_.assign(corners.begin(), corners.end());
    for (long long& corner : corners_) {
      if (corner < 0 || corner >= points_)
        at.fail("cell " + std::to_string(cell) + " has the point " + std::to_string(corner) +
                ", which is not there, expected one of the piece's " + std::to_string(points_));
      corner += before_;
    }
    return corners_;
  }

  VtkArrays arrays_;
  MeshBuilder builder_;
  long long before_ = 0, points_ = 0;  // points of the pieces before, and of this one
  std::vector<long long> corners_;
};

}  // namespace

bool is_xml(std::string_view beginning) { return trimmed(beginning.substr(0, 100)).starts_with('<'); }

AnyMesh parse_vtk_xml(const std::string& source, std::string_view text) {
  return VtkXmlReader(source, text).read();
}

}  // namespace springstab
