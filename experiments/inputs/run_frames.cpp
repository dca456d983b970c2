#include "experiments/inputs/run_frames.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <limits>
#include <map>

#include "solvers/io/input_error.h"
#include "solvers/io/npy.h"
#include "solvers/io/ply.h"
#include "solvers/io/ply_header.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

namespace fs = std::filesystem;

constexpr int most_components = 3;

struct FrameFile {
  std::vector<double> numbers;
  int components;
};

// Also "nan", "-nan(ind)", "inf" and "-1.#IND", as blown-up runs are written.
double position_of(const Location& at, std::string_view word) {
  const std::size_t sign = word.starts_with('-') || word.starts_with('+');
  const std::string name = uppercase(word.substr(sign, 3));
  if (name == "NAN" || name == "INF" || word.find("#I") != word.npos || word.find("#Q") != word.npos)
    return std::numeric_limits<double>::quiet_NaN();
  return at.real(word);
}

FrameFile obj_frame(const std::string& path) {
  const std::string content = read_text_file(path);
  FrameFile frame{{}, 3};
  std::vector<std::string_view> words;
  for (LineReader lines(path, content); lines.next();) {
    words.clear();
    append_words(lines.line(), words, '#');
    if (words.empty() || words[0] != "v") continue;
    if (words.size() < 4)
      lines.at().fail("a vertex has " + std::to_string(words.size() - 1) + " numbers, expected x, y and z");
    for (int i = 1; i <= 3; ++i) frame.numbers.push_back(position_of(lines.at(), words[i]));
  }
  if (frame.numbers.empty()) throw InputError(path, 0, "has no vertices, expected lines 'v x y z'");
  return frame;
}

FrameFile vtk_frame(const std::string& path) {
  const std::string content = read_text_file(path);
  FrameFile frame{{}, 3};
  std::vector<std::string_view> words;
  LineReader lines(path, content);
  while (lines.next()) {
    words.clear();
    append_words(lines.line(), words);
    if (!words.empty() && uppercase(words[0]) == "POINTS") break;
  }
  if (words.size() < 3) lines.at().fail("the file ends, expected POINTS, their number and type");
  const long long count = lines.at().integer(words[1]);
  for (std::size_t next = 3; static_cast<long long>(frame.numbers.size()) < 3 * count;) {
    if (next == words.size()) {
      words.clear(), next = 0;
      if (!lines.next()) lines.at().fail("the file ends, expected " + std::to_string(count) + " points");
      append_words(lines.line(), words);
    } else {
      frame.numbers.push_back(position_of(lines.at(), words[next++]));
    }
  }
  if (frame.numbers.empty()) throw InputError(path, 0, "has no points, expected some");
  return frame;
}

// Of the vertices x, y and z; what stands before them is skipped, what stands behind them not looked at.
FrameFile ply_frame(const std::string& path) {
  const std::string content = read_file(path, is_binary_ply);
  PlyNumbers numbers(path, content);
  FrameFile frame{{}, 3};
  constexpr std::string_view axes = "xyz";
  for (const PlyElement& element : numbers.elements()) {
    const bool vertex = element.name == "vertex";
    const auto has = [&](const char axis) {
      return std::ranges::any_of(element.properties, [&](const PlyProperty& p) {
        return !p.count && p.name == std::string(1, axis);
      });
    };
    if (vertex && !std::ranges::all_of(axes, has))
      element.at.fail("the vertices lack one of the properties x, y and z, expected all three");
    numbers.expect_room(element);
    for (long long i = 0; i < element.count; ++i) {
      numbers.begin(element);
      std::array<double, most_components> position{};
      for (const PlyProperty& property : element.properties) {
        const std::size_t axis = axes.find(property.name);
        if (!property.count && property.name.size() == 1 && axis != axes.npos)
          position[axis] = numbers.next(property.type, property.name);
        else
          for (long long left = property.count ? numbers.length(property) : 1; left > 0; --left)
            numbers.next(property.type, property.name);
      }
      numbers.end(element);
      if (vertex) frame.numbers.insert(frame.numbers.end(), position.begin(), position.end());
    }
    if (vertex) break;
  }
  if (frame.numbers.empty()) throw InputError(path, 0, "has no vertices, expected an element vertex");
  return frame;
}

FrameFile npy_frame(const std::string& path) {
  NpyArray array = read_npy(path);
  const std::size_t dimensions = array.shape.size();
  if (dimensions == 2 && array.shape[1] <= most_components)
    return {std::move(array.values), static_cast<int>(array.shape[1])};
  if (dimensions == 1) return {std::move(array.values), 1};
  throw InputError(
      path, 0,
      "has " + std::to_string(dimensions) + " dimensions, expected a frame: (vertices, 3) or (numbers)");
}

RunFrames all_frames(const std::string& path) {
  const NpyArray array = read_npy(path);
  const std::size_t dimensions = array.shape.size();
  if (dimensions < 2 || dimensions > 3 || (dimensions == 3 && array.shape[2] > most_components))
    throw InputError(path, 0,
                     "has " + std::to_string(dimensions) +
                         " dimensions, expected (frames, vertices, 3) or (frames, numbers)");
  const auto frames = static_cast<Eigen::Index>(array.shape[0]);
  return {Eigen::MatrixXd::Map(array.values.data(), static_cast<Eigen::Index>(array.values.size()) / frames,
                               frames),
          dimensions == 3 ? static_cast<int>(array.shape[2]) : 1};
}

// Digits count as the number they are: 2 before 10.
bool in_order_of_numbers(const std::string& a, const std::string& b) {
  const auto digit = [](const std::string& s, std::size_t i) {
    return i < s.size() && std::isdigit(static_cast<unsigned char>(s[i]));
  };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a, i) || !digit(b, j)) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (a[i] == '0' && digit(a, i + 1)) ++i;
    while (b[j] == '0' && digit(b, j + 1)) ++j;
    const std::size_t from_i = i, from_j = j;
    while (digit(a, i)) ++i;
    while (digit(b, j)) ++j;
    const std::string_view x(a.data() + from_i, i - from_i), y(b.data() + from_j, j - from_j);
    if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
  }
  return a.size() - i < b.size() - j || (a.size() - i == b.size() - j && a < b);
}

using FrameReader = FrameFile (*)(const std::string& path);

// The files of the one kind that the folder has, and their reader.
std::pair<std::vector<std::string>, FrameReader> frame_files(const std::string& folder) {
  static const std::map<std::string, FrameReader> readers{
      {".NPY", npy_frame}, {".OBJ", obj_frame}, {".PLY", ply_frame}, {".VTK", vtk_frame}};
  std::map<std::string, std::vector<std::string>> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (const std::string suffix = uppercase(entry.path().extension().string()); readers.contains(suffix))
      found[suffix].push_back(entry.path().string());
  if (error)
    throw InputError(folder, 0, "cannot be read (" + error.message() + "), expected a folder of frames");
  if (found.empty()) throw InputError(folder, 0, "has no frames, expected .obj, .ply, .vtk or .npy files");
  if (found.size() > 1)
    throw InputError(folder, 0,
                     "has frames of " + std::to_string(found.size()) +
                         " kinds, expected one of .obj, .ply, .vtk and .npy");
  auto& [suffix, files] = *found.begin();
  std::ranges::sort(files, in_order_of_numbers);
  return {std::move(files), readers.at(suffix)};
}

RunFrames frames_of_folder(const std::string& folder) {
  auto [files, reader] = frame_files(folder);
  RunFrames run;
  for (std::size_t n = 0; n < files.size(); ++n) {
    const FrameFile frame = reader(files[n]);
    const auto size = static_cast<Eigen::Index>(frame.numbers.size());
    if (n == 0) {
      run.positions.resize(size, static_cast<Eigen::Index>(files.size()));
      run.components = frame.components;
    }
    if (size != run.positions.rows() || frame.components != run.components)
      throw InputError(files[n], 0,
                       "has " + std::to_string(size / frame.components) + " vertices, expected " +
                           std::to_string(run.positions.rows() / run.components) + " as in " + files[0]);
    run.positions.col(static_cast<Eigen::Index>(n)) = Eigen::VectorXd::Map(frame.numbers.data(), size);
  }
  run.files = std::move(files);
  return run;
}

}  // namespace

RunFrames read_frames(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error))
    throw InputError(path, 0, "is not there, expected a folder of frames or a .npy file");
  RunFrames run = fs::is_directory(path, error) ? frames_of_folder(path) : all_frames(path);
  if (run.positions.cols() < 2)
    throw InputError(path, 0, "has one frame, expected those of a run, in the order of their steps");
  return run;
}

}  // namespace springstab
