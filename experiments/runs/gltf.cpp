#include "experiments/runs/gltf.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "experiments/command/output.h"
#include "solvers/io/binary_reader.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr int float_type = 5126, index_type = 5125, vertex_target = 34962, index_target = 34963;

// Little endian.
template <class Number>
void add_bytes(std::string& bytes, Number number) {
  std::string own(sizeof number, '\0');
  std::memcpy(own.data(), &number, sizeof number);
  if (std::endian::native == std::endian::big) std::ranges::reverse(own);
  bytes += own;
}

std::vector<float> floats_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  if (!file || !(content << file.rdbuf()))
    throw InputError(path, 0, "cannot be read, expected the frame that was written there");
  std::vector<float> all;
  for (BinaryReader reader(path, content.view(), std::endian::little); reader.bytes_left() > 0;)
    all.push_back(reader.next<float>("a coordinate"));
  return all;
}

void write_file(const std::string& path, const std::string& content) {
  OutputFile file(path);
  file.stream() << content;
  file.commit();
}

// The parts of a glTF file, which name each other by their places in lists.
class GltfFile {
 public:
  Json add_buffer(const std::string& uri, std::size_t bytes) {
    json_["buffers"].push_back({{"uri", uri}, {"byteLength", bytes}});
    return json_["buffers"].size() - 1;
  }
  Json add_accessor(Json accessor, const Json& buffer, std::size_t offset, std::size_t bytes,
                    int target = 0) {
    Json view{{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", bytes}};
    if (target > 0) view["target"] = target;
    json_["bufferViews"].push_back(view);
    accessor["bufferView"] = json_["bufferViews"].size() - 1;
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }
  Json& json() { return json_; }

 private:
  Json json_{{"asset", {{"version", "2.0"}, {"generator", "springstab"}}},
             {"scene", 0},
             {"scenes", {{{"nodes", {0}}}}},
             {"nodes", {{{"mesh", 0}}}},
             {"materials", {{{"doubleSided", true}}}}};
};

// Three numbers each, with the least and the greatest of them, which readers want to know.
Json positions_accessor(const std::vector<float>& numbers) {
  Json least = Json::array(), greatest = Json::array();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float low = std::numeric_limits<float>::max(), high = -low;
    for (std::size_t i = axis; i < numbers.size(); i += 3)
      low = std::min(low, numbers[i]), high = std::max(high, numbers[i]);
    least.push_back(low), greatest.push_back(high);
  }
  return {{"componentType", float_type},
          {"count", numbers.size() / 3},
          {"type", "VEC3"},
          {"min", least},
          {"max", greatest}};
}

}  // namespace

std::string gltf_frame(const std::string& first, const std::vector<Eigen::Vector3d>& positions) {
  std::vector<float> base(3 * positions.size(), 0.F);
  if (!first.empty()) base = floats_of(first);
  if (base.size() != 3 * positions.size())
    throw InputError(
        first, 0,
        "has " + std::to_string(base.size()) + " numbers, expected " + std::to_string(3 * positions.size()));
  std::string bytes;
  for (std::size_t i = 0; i < base.size(); ++i)
    add_bytes(bytes,
              static_cast<float>(positions[i / 3][static_cast<Eigen::Index>(i % 3)] - double{base[i]}));
  return bytes;
}

void write_gltf(const std::string& folder, const std::vector<std::string>& frames,
                const std::vector<double>& times, const std::vector<std::vector<int>>& faces) {
  GltfFile gltf;
  Json targets = Json::array(), base;
  std::size_t count = 0;  // frames
  for (const std::string& path : frames) {
    const std::vector<float> numbers = floats_of(path);
    if (!std::ranges::all_of(numbers, [](float x) { return std::isfinite(x); })) break;
    const std::size_t bytes = sizeof(float) * numbers.size();
    const Json buffer = gltf.add_buffer(std::filesystem::path(path).filename().string(), bytes);
    const Json accessor = gltf.add_accessor(positions_accessor(numbers), buffer, 0, bytes, vertex_target);
    if (count++ == 0)
      base = accessor;
    else
      targets.push_back({{"POSITION", accessor}});
  }
  if (count == 0) return;

  std::string data;
  std::uint32_t corners = 0;
  for (const std::vector<int>& face : faces)
    for (std::size_t k = 2; k < face.size(); ++k, corners += 3)
      for (const int v : {face[0], face[k - 1], face[k]}) add_bytes(data, static_cast<std::uint32_t>(v));
  const std::size_t triangles_end = data.size();
  float time = -std::numeric_limits<float>::max(), first_time = 0;
  for (std::size_t i = 0; i < count; ++i) {  // ascending, also in single precision
    time = std::max(static_cast<float>(times[i]), std::nextafter(time, std::numeric_limits<float>::max()));
    if (i == 0) first_time = time;
    add_bytes(data, time);
  }
  const std::size_t times_end = data.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t target = 1; target < count; ++target) add_bytes(data, i == target ? 1.F : 0.F);

  const Json buffer = gltf.add_buffer("frames.bin", data.size());
  const Json indices =
      gltf.add_accessor({{"componentType", index_type}, {"count", corners}, {"type", "SCALAR"}}, buffer, 0,
                        triangles_end, index_target);
  Json primitive{{"attributes", {{"POSITION", base}}}, {"indices", indices}, {"material", 0}};
  Json mesh;
  if (!targets.empty()) {
    primitive["targets"] = targets;
    mesh["weights"] = std::vector<int>(count - 1, 0);
    const Json input = gltf.add_accessor({{"componentType", float_type},
                                          {"count", count},
                                          {"type", "SCALAR"},
                                          {"min", {first_time}},
                                          {"max", {time}}},
                                         buffer, triangles_end, times_end - triangles_end);
    const Json output =
        gltf.add_accessor({{"componentType", float_type}, {"count", count * (count - 1)}, {"type", "SCALAR"}},
                          buffer, times_end, data.size() - times_end);
    const Json sampler{{"input", input}, {"output", output}, {"interpolation", "LINEAR"}},
        channel{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}};
    gltf.json()["animations"] =
        Json::array({{{"samplers", Json::array({sampler})}, {"channels", Json::array({channel})}}});
  }
  mesh["primitives"] = Json::array({primitive});
  gltf.json()["meshes"] = Json::array({mesh});
  write_file(folder + "/frames.bin", data);
  write_file(folder + "/frames.gltf", gltf.json().dump());
}

}  // namespace springstab
