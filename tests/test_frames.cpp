// Frames as other programs want them: what is written reads back, and what belongs together is whole.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "experiments/command/output.h"
#include "experiments/inputs/run_frames.h"
#include "experiments/runs/frames.h"
#include "solvers/io/binary_reader.h"
#include "solvers/io/mesh_file.h"
#include "solvers/io/xml_file.h"
#include "tests/meshes.h"
#include "tests/refusals.h"
#include "tests/scratch.h"

BOOST_AUTO_TEST_SUITE(frames)

using namespace springstab;
using springstab::test::content_of;
using springstab::test::expect_error;
using springstab::test::ScratchFolder;
using FrameFaces = std::vector<std::vector<int>>;

namespace {

const FrameFaces faces{{0, 1, 2, 3}, {1, 4, 2}};

std::vector<Eigen::Vector3d> moved(int frame) {
  std::vector<Eigen::Vector3d> places{{0, 0, 0}, {1, 0, 0.1}, {1.1, 1, 0}, {0, 0.9, -0.05}, {2, 0.25, 0.3}};
  for (Eigen::Vector3d& p : places) p += Eigen::Vector3d(0.1, -0.03 * frame, std::sin(p.x())) * frame / 3;
  return places;
}

const std::vector<double> frame_times{0, 0.1, 0.30000000000000004};

void write_run(const ScratchFolder& folder, const std::string& format) {
  for (int frame = 0; frame < 3; ++frame) write_frame(folder.path(), format, frame, moved(frame), faces);
  write_series(folder.path(), format, frame_times, faces);
}

std::vector<float> numbers_of(const std::string& content, std::size_t begin, std::size_t bytes) {
  std::vector<float> all;
  BinaryReader reader("a file", content, std::endian::little, begin);
  while (reader.position() < begin + bytes) all.push_back(reader.next<float>("a number"));
  return all;
}

}  // namespace

BOOST_AUTO_TEST_CASE(frames_read_back_to_the_last_bit) {
  for (const std::string format : {"obj", "ply", "vtk", "pvd"}) BOOST_TEST_CONTEXT(format) {
      if (format == "pvd" && !has_expat()) continue;
      const ScratchFolder folder;
      write_run(folder, format);
      for (int frame = 0; frame < 3; ++frame) {
        const AnyMesh mesh = read_mesh(frame_path(folder.path(), format, frame));
        BOOST_TEST((std::get<Mesh>(mesh).vertices == moved(frame)));
        BOOST_TEST((test::faces_of(std::get<Mesh>(mesh)) == faces));
      }
      if (format == "pvd") continue;
      const RunFrames run = read_frames(folder.path());
      BOOST_TEST(run.components == 3);
      for (int frame = 0; frame < 3; ++frame)
        for (int v = 0; v < 5; ++v)
          BOOST_TEST(
              (run.positions.col(frame).segment<3>(3 * v) == moved(frame)[static_cast<std::size_t>(v)]));
    }
}

BOOST_AUTO_TEST_CASE(a_face_of_many_corners_is_a_longer_list_in_a_ply_frame) {
  const ScratchFolder folder;
  std::vector<Eigen::Vector3d> ring;
  std::vector<int> face;
  for (int i = 0; i < 300; ++i) {
    ring.emplace_back(std::cos(i * 0.02), std::sin(i * 0.02), 0.1 * i);
    face.push_back(i);
  }
  write_frame(folder.path(), "ply", 0, ring, {face});
  const AnyMesh mesh = read_mesh(frame_path(folder.path(), "ply", 0));
  BOOST_TEST((std::get<Mesh>(mesh).vertices == ring));
  BOOST_TEST((test::faces_of(std::get<Mesh>(mesh)) == FrameFaces{face}));
}

BOOST_AUTO_TEST_CASE(a_blown_up_ply_frame_is_read_as_it_is) {
  const ScratchFolder folder;
  std::vector<Eigen::Vector3d> last = moved(1);
  last[2].y() = std::numeric_limits<double>::quiet_NaN();
  last[4].z() = std::numeric_limits<double>::infinity();
  write_frame(folder.path(), "ply", 0, moved(0), faces);
  write_frame(folder.path(), "ply", 1, last, faces);
  const RunFrames run = read_frames(folder.path());
  BOOST_TEST(std::isnan(run.positions(7, 1)));
  BOOST_TEST(std::isinf(run.positions(14, 1)));
  BOOST_TEST(run.positions.col(1).head<7>().allFinite());
  folder.file("frame_00001.ply",
              "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n");
  expect_error([&] { read_frames(folder.path()); }, frame_path(folder.path(), "ply", 1) + ":3", "x, y and z");
}

BOOST_AUTO_TEST_CASE(a_series_names_each_frame_with_its_time) {
  const ScratchFolder folder;
  write_run(folder, "pvd");
  const std::string pvd = content_of(folder.path() / "frames.pvd");
  std::size_t at = 0;
  for (const char* line : {"<DataSet timestep=\"0\" file=\"frame_00000.vtp\"/>",
                           "<DataSet timestep=\"0.10000000000000001\" file=\"frame_00001.vtp\"/>",
                           "<DataSet timestep=\"0.30000000000000004\" file=\"frame_00002.vtp\"/>"}) {
    BOOST_TEST_CONTEXT(line << " in " << pvd) { BOOST_REQUIRE((at = pvd.find(line, at)) != pvd.npos); }
  }
  if (has_expat()) BOOST_CHECK_NO_THROW(read_xml("frames.pvd", pvd, ""));
}

// glTF 2.0: buffers are whole, views lie in them, accessors in views; target k is at its weight 1 at time k.
BOOST_AUTO_TEST_CASE(frames_are_one_animation_in_gltf) {
  const ScratchFolder folder;
  write_run(folder, "gltf");
  const Json gltf = Json::parse(content_of(folder.path() / "frames.gltf"));
  BOOST_TEST(gltf.at("asset").at("version") == "2.0");
  std::vector<std::string> buffers;
  for (const Json& buffer : gltf.at("buffers")) {
    buffers.push_back(content_of(folder.path() / buffer.at("uri").get<std::string>()));
    BOOST_TEST(buffers.back().size() == buffer.at("byteLength").get<std::size_t>());
  }
  const auto numbers = [&](const Json& accessor_index, std::size_t components) {
    const Json& accessor = gltf.at("accessors").at(accessor_index.get<std::size_t>());
    const Json& view = gltf.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    const std::string& buffer = buffers.at(view.at("buffer").get<std::size_t>());
    const auto begin = view.at("byteOffset").get<std::size_t>(),
               bytes = view.at("byteLength").get<std::size_t>();
    BOOST_TEST(begin % 4 == 0u);
    BOOST_REQUIRE(begin + bytes <= buffer.size());
    BOOST_TEST(bytes == 4 * components * accessor.at("count").get<std::size_t>());
    return numbers_of(buffer, begin, bytes);
  };
  const Json& primitive = gltf.at("meshes").at(0).at("primitives").at(0);
  const std::vector<float> base = numbers(primitive.at("attributes").at("POSITION"), 3);
  BOOST_REQUIRE_EQUAL(primitive.at("targets").size(), 2u);
  BOOST_TEST(gltf.at("meshes").at(0).at("weights").size() == 2u);
  for (int frame = 1; frame < 3; ++frame) {
    const Json& index = primitive.at("targets").at(static_cast<std::size_t>(frame) - 1).at("POSITION");
    const std::vector<float> difference = numbers(index, 3);
    const Json& accessor = gltf.at("accessors").at(index.get<std::size_t>());
    for (std::size_t i = 0; i < difference.size(); ++i) {
      const double x = moved(frame)[i / 3][static_cast<Eigen::Index>(i % 3)];
      // two roundings to single precision of numbers below 4
      BOOST_TEST(std::abs(double{base[i]} + difference[i] - x) <= 2 * 4 * 0x1p-24);
      BOOST_TEST(difference[i] >= accessor.at("min").at(i % 3).get<float>());
      BOOST_TEST(difference[i] <= accessor.at("max").at(i % 3).get<float>());
    }
  }
  const Json& sampler = gltf.at("animations").at(0).at("samplers").at(0);
  BOOST_TEST((numbers(sampler.at("input"), 1) == std::vector<float>{0, 0.1F, 0.3F}));
  BOOST_TEST((numbers(sampler.at("output"), 1) == std::vector<float>{0, 0, 1, 0, 0, 1}));
  BOOST_TEST(gltf.at("animations").at(0).at("channels").at(0).at("target").at("path") == "weights");

  const std::string& last = buffers.back();
  std::vector<std::uint32_t> triangles;
  const Json& accessor = gltf.at("accessors").at(primitive.at("indices").get<std::size_t>());
  BinaryReader reader("a file", last, std::endian::little);
  for (std::size_t i = 0; i < accessor.at("count").get<std::size_t>(); ++i)
    triangles.push_back(reader.next<std::uint32_t>("an index"));
  BOOST_TEST((triangles == std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 1, 4, 2}));
}

BOOST_AUTO_TEST_CASE(a_gltf_animation_ends_before_what_is_not_finite) {
  const ScratchFolder folder;
  write_frame(folder.path(), "gltf", 0, moved(0), faces);
  write_frame(folder.path(), "gltf", 1, moved(1), faces);
  std::vector<Eigen::Vector3d> blown = moved(2);
  blown[0].x() = 1e300;  // beyond single precision
  write_frame(folder.path(), "gltf", 2, blown, faces);
  write_series(folder.path(), "gltf", frame_times, faces);
  const Json gltf = Json::parse(content_of(folder.path() / "frames.gltf"));
  BOOST_TEST(gltf.at("meshes").at(0).at("primitives").at(0).at("targets").size() == 1u);
  std::filesystem::remove(frame_path(folder.path(), "gltf", 1));
  expect_error([&] { write_series(folder.path(), "gltf", frame_times, faces); },
               frame_path(folder.path(), "gltf", 1), "cannot be read");
}

BOOST_AUTO_TEST_SUITE_END()
