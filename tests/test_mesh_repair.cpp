// What is mended in a mesh file: each defect by itself and all together, counted; what is left is the mesh
// that the file meant, and pins and frames keep the file's numbers.
#include <boost/test/unit_test.hpp>
#include <random>
#include <string>
#include <vector>

#include "analysis/method.h"
#include "analysis/spectra/spectrum.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/subject.h"
#include "solvers/io/input_error.h"
#include "solvers/io/obj.h"
#include "solvers/scene/mesh_repair.h"
#include "tests/meshes.h"
#include "tests/scratch.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(mesh_repair)

using namespace springstab;
using springstab::test::Faces;
using springstab::test::faces_of;
using springstab::test::make_mesh;

namespace {

using Positions = std::vector<Eigen::Vector3d>;

/// merged, shortened, degenerate, duplicate, unreferenced, crowded
std::vector<int> counts(const MeshRepair& r) {
  return {r.merged_vertices,    r.shortened_elements,    r.degenerate_elements,
          r.duplicate_elements, r.unreferenced_vertices, r.crowded};
}

const Positions square{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};

Positions with(Positions list, const Positions& more) {
  list.insert(list.end(), more.begin(), more.end());
  return list;
}

/// A scene from a file that is there as long as this.
class FromFile {
 public:
  FromFile(const std::string& text, const std::string& pin = "") : file_(text, "cloth.obj") {
    InputOptions input;
    input.file = file_.name();
    input.pin = pin;
    subject.emplace(input);
  }

 private:
  test::ScratchFile file_;

 public:
  std::optional<Subject> subject;
};

/// Two triangles that meet at an edge whose vertices stand there twice (as programs that split vertices at
/// seams write them), one vertex alone, a triangle on an edge, and the second triangle again, backwards.
const std::string nasty =
    "v 9 9 9\n"
    "v 0 0 0\nv 1 0 0\nv 0 0 1\n"
    "v 1 0 0\nv 0 -0 1\nv 1 0 1\n"
    "f 2 3 4\nf 5 7 6\nf 3 5 4\nf 4 7 3\n";

}  // namespace

BOOST_AUTO_TEST_CASE(a_sound_mesh_stays_as_it_is) {
  const Mesh mesh = make_mesh(square, {{0, 1, 2}, {0, 2, 3}});
  const auto [out, repair] = repaired(mesh);
  BOOST_TEST(!repair.changed());
  BOOST_TEST((counts(repair) == std::vector<int>{0, 0, 0, 0, 0, 0}));
  BOOST_TEST((repair.vertex == std::vector<int>{0, 1, 2, 3}));
  BOOST_TEST((out.vertices == mesh.vertices));
  BOOST_TEST((faces_of(out) == faces_of(mesh)));
  BOOST_TEST((out.vertex_line == mesh.vertex_line));
  BOOST_TEST((out.face_line == mesh.face_line));
}

BOOST_AUTO_TEST_CASE(each_defect_is_mended_and_counted) {
  const struct {
    std::string name;
    Mesh mesh;
    std::vector<int> counts;
    std::vector<int> vertex;
    Faces faces;
  } cases[] = {
      {"a seam",
       make_mesh(with(square, {{0, 0, 0}, {1, 0, 1}}), {{0, 1, 2}, {4, 5, 3}}),
       {2, 0, 0, 0, 0, 0},
       {0, 1, 2, 3, 0, 2},
       {{0, 1, 2}, {0, 2, 3}}},
      {"minus zero",
       make_mesh(with(square, {{0, -0.0, 0}}), {{0, 1, 2}, {4, 2, 3}}),
       {1, 0, 0, 0, 0, 0},
       {0, 1, 2, 3, 0},
       {{0, 1, 2}, {0, 2, 3}}},
      {"a hair apart",
       make_mesh(with(square, {{1e-300, 0, 0}}), {{0, 1, 2}, {4, 2, 3}}),
       {0, 0, 0, 0, 0, 0},
       {0, 1, 2, 3, 4},
       {{0, 1, 2}, {4, 2, 3}}},
      {"a quad with a corner twice",
       make_mesh(square, {{0, 1, 2, 2}, {0, 2, 3, 0}}),
       {0, 2, 0, 0, 0, 0},
       {0, 1, 2, 3},
       {{0, 1, 2}, {0, 2, 3}}},
      {"a quad at a pole",
       make_mesh(with(square, {{1, 0, 1}}), {{0, 1, 2, 4}, {0, 2, 3}}),
       {1, 1, 0, 0, 0, 0},
       {0, 1, 2, 3, 2},
       {{0, 1, 2}, {0, 2, 3}}},
      {"a triangle at a pole",
       make_mesh(with(square, {{1, 0, 1}}), {{0, 1, 2}, {1, 4, 2}, {0, 4, 3}}),
       {1, 0, 1, 0, 0, 0},
       {0, 1, 2, 3, 2},
       {{0, 1, 2}, {0, 2, 3}}},
      {"a face that is a point",
       make_mesh(square, {{1, 1, 1, 1}, {0, 1, 2, 3}}),
       {0, 0, 1, 0, 0, 0},
       {0, 1, 2, 3},
       {{0, 1, 2, 3}}},
      {"turned and reversed faces",
       make_mesh(square, {{0, 1, 2, 3}, {2, 3, 0, 1}, {1, 0, 3, 2}}),
       {0, 0, 0, 2, 0, 0},
       {0, 1, 2, 3},
       {{0, 1, 2, 3}}},
      {"the same corners in another order",
       make_mesh(square, {{0, 1, 2, 3}, {0, 2, 1, 3}}),
       {0, 0, 0, 0, 0, 0},
       {0, 1, 2, 3},
       {{0, 1, 2, 3}, {0, 2, 1, 3}}},
      {"a loose vertex",
       make_mesh(with({{7, 7, 7}}, square), {{1, 2, 3, 4}}),
       {0, 0, 0, 0, 1, 0},
       {-1, 0, 1, 2, 3},
       {{0, 1, 2, 3}}},
      {"a loose vertex on a corner",
       make_mesh(with({{1, 0, 0}}, square), {{1, 2, 3, 4}}),
       {1, 0, 0, 0, 0, 0},
       {0, 1, 0, 2, 3},
       {{1, 0, 2, 3}}},
      {"two loose vertices in one place",
       make_mesh(with(square, {{5, 5, 5}, {5, 5, 5}}), {{0, 1, 2, 3}}),
       {0, 0, 0, 0, 2, 0},
       {0, 1, 2, 3, -1, -1},
       {{0, 1, 2, 3}}},
      {"a book",
       make_mesh(with(square, {{0, 1, 0}}), {{0, 1, 2}, {0, 2, 3}, {0, 2, 4}}),
       {0, 0, 0, 0, 0, 1},
       {0, 1, 2, 3, 4},
       {{0, 1, 2}, {0, 2, 3}, {0, 2, 4}}},
  };
  for (const auto& c : cases) BOOST_TEST_CONTEXT(c.name) {
      const auto [out, repair] = repaired(c.mesh);
      BOOST_TEST(counts(repair) == c.counts, boost::test_tools::per_element());
      BOOST_TEST(repair.vertex == c.vertex, boost::test_tools::per_element());
      BOOST_TEST((faces_of(out) == c.faces));
      BOOST_TEST(repair.changed() == (c.counts != std::vector<int>{0, 0, 0, 0, 0, c.counts[5]}));
      check(out);  // fit for a cloth
      for (std::size_t v = 0; v < c.mesh.vertices.size(); ++v)
        if (const int now = repair.vertex[v]; now >= 0) BOOST_TEST((out.vertices[now] == c.mesh.vertices[v]));
    }
}

BOOST_AUTO_TEST_CASE(what_is_mended_once_needs_no_mending) {
  std::mt19937_64 random(3);
  const auto pick = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  int changed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Positions vertices;
    for (int v = 0; v < 12; ++v) vertices.emplace_back(pick(3), 0, pick(3));
    Faces faces{{0, 1, 2}};
    vertices[0] = {0, 0, 0}, vertices[1] = {1, 0, 0}, vertices[2] = {1, 0, 1};
    for (int f = 0; f < 10; ++f) faces.push_back({pick(12), pick(12), pick(12)});
    const auto [once, first] = repaired(make_mesh(vertices, faces));
    const auto [twice, second] = repaired(once);
    changed += first.changed();
    BOOST_TEST(!second.changed());
    BOOST_TEST((twice.vertices == once.vertices));
    BOOST_TEST((faces_of(twice) == faces_of(once)));
    BOOST_TEST(first.crowded == second.crowded);
    check(once);
  }
  BOOST_TEST(changed > 150);
}

BOOST_AUTO_TEST_CASE(texture_coordinates_stay_with_their_corners) {
  Mesh mesh = make_mesh(with(square, {{1, 0, 1}}), {{0, 1, 1}, {0, 1, 2, 4}, {0, 2, 3}});
  for (int corner = 0; corner < 10; ++corner) mesh.corner_uv.emplace_back(corner, -corner);
  const Mesh out = repaired(mesh).mesh;
  const std::vector<double> expected{3, 4, 5, 7, 8, 9};
  BOOST_REQUIRE_EQUAL(out.corner_uv.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) BOOST_TEST(out.corner_uv[i].x() == expected[i]);
  BOOST_TEST((out.face_line == std::vector<long>{7, 8}));
}

BOOST_AUTO_TEST_CASE(a_mesh_of_which_nothing_is_left_is_refused_at_the_first_face) {
  const Mesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, {{0, 1, 2}, {1, 1, 0}});
  BOOST_CHECK_EXCEPTION(repaired(mesh), InputError, [](const InputError& error) {
    return std::string(error.what()).starts_with("cloth.obj:4: ") &&
           std::string(error.what()).find("expected") != std::string::npos;
  });
}

BOOST_AUTO_TEST_CASE(a_face_that_meets_itself_is_left_to_be_refused) {
  const Mesh out = repaired(make_mesh(square, {{0, 1, 0, 2}, {0, 1, 2, 3}})).mesh;
  BOOST_CHECK_THROW(check(out), InputError);
}

BOOST_AUTO_TEST_CASE(pins_and_frames_keep_the_numbers_of_the_file) {
  FromFile sound("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 2 3\nf 2 4 3\n", "1,2");
  // the seam's second vertices, and one that stays wherever it is
  FromFile mended(nasty, "0,4,5");
  Subject &plain = *sound.subject, &subject = *mended.subject;
  const Json json = mesh_json(subject);
  BOOST_TEST(json["merged_vertices"] == 2);
  BOOST_TEST(json["degenerate_faces"] == 1);
  BOOST_TEST(json["duplicate_faces"] == 1);
  BOOST_TEST(json["unreferenced_vertices"] == 1);
  BOOST_TEST(json["vertices"] == 7u);
  BOOST_TEST(mesh_json(plain)["merged_vertices"] == 0);

  State<Vector> a = plain.initial_state(1), b = subject.initial_state(1);
  BOOST_REQUIRE((a.x == b.x));
  for (Subject* s : {&plain, &subject}) {
    State<Vector>& state = s == &plain ? a : b;
    const auto stepper = Method("symplectic-euler").stepper();
    for (int i = 0; i < 20; ++i) BOOST_REQUIRE((stepper->step(s->system(), 1e-3, state) == StepStatus::done));
  }
  BOOST_TEST((a.x == b.x));
  const Positions p = plain.vertices(a.x), q = subject.vertices(b.x);
  BOOST_REQUIRE_EQUAL(q.size(), 7u);
  BOOST_TEST((q[0] == Eigen::Vector3d(9, 9, 9)));
  const int same[] = {0, 1, 2, 1, 2, 3};
  for (int v = 0; v < 6; ++v) BOOST_TEST((q[v + 1] == p[same[v]]));
  BOOST_TEST((q[1] - Eigen::Vector3d(0, 0, 0)).norm() > 1e-4);  // it fell
  BOOST_TEST(subject.faces().size() == 4u);
  for (const auto& face : subject.faces())
    for (const int v : face) BOOST_TEST(v < 7);
}

BOOST_AUTO_TEST_CASE(pins_beyond_the_file_are_refused) {
  BOOST_CHECK_THROW(FromFile(nasty, "7"), InputError);
  FromFile(nasty, "6");
}

BOOST_AUTO_TEST_CASE(meshes_of_other_programs_are_mended_as_published) {
  struct Published {
    std::string name;
    std::vector<int> counts;
    int vertices, faces;
  };
  for (const auto& [name, expected, vertices, faces] :
       {Published{"pbd_plane_30x30.obj", {0, 0, 0, 0, 0, 0}, 961, 1800},
        {"cipc_skirt16x64.obj", {0, 0, 0, 0, 0, 0}, 1024, 1920},
        {"vega_bend2_quads.obj", {0, 0, 0, 0, 0, 0}, 55, 40},
        {"sofa_frog_eyes.obj", {16, 0, 32, 0, 0, 0}, 516, 1024},
        {"gc_fan3.obj", {0, 0, 0, 0, 0, 1}, 5, 3},
        {"sofa_collision_no_face.obj", {0, 0, 0, 2, 272, 0}, 194, 194}})
    if (const auto path = test::shared_data("meshes/" + name)) BOOST_TEST_CONTEXT(name) {
        const auto [mesh, repair] = repaired(read_obj(path->string()));
        BOOST_TEST(counts(repair) == expected, boost::test_tools::per_element());
        BOOST_TEST(mesh.vertices.size() == static_cast<std::size_t>(vertices));
        BOOST_TEST(mesh.faces() == faces);
        for (const char* material : {"default", "baraff-witkin"}) BOOST_TEST_CONTEXT(material) {
            InputOptions input;
            input.file = path->string();
            input.material = material;
            input.pin = "0";
            Subject subject(input);
            const State<Vector> start = subject.initial_state(1);
            const StiffestMode k0 = stiffest_mode(subject.structure(start).matrices, {});
            BOOST_TEST(k0.converged);
            BOOST_TEST(k0.value > 1);
            State<Vector> state = start;
            const auto stepper = Method("symplectic-euler").stepper();
            const double h = 1 / std::sqrt(k0.value);  // half the limit
            for (int i = 0; i < 50; ++i)
              BOOST_REQUIRE((stepper->step(subject.system(), h, state) == StepStatus::done));
            BOOST_TEST((state.x - start.x).norm() > 0);
            BOOST_TEST(subject.vertices(state.x).size() == repair.vertex.size());
          }
      }
}

BOOST_AUTO_TEST_SUITE_END()
