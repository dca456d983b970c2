// What a run gave, as far as two runs of the same command must agree on it: everything but what a clock says.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "experiments/command/output.h"
#include "tests/scratch.h"

namespace springstab::test {

/// Without what is measured by a clock, and what is fitted to that.
inline Json untimed(Json report) {
  static const std::set<std::string> timed{"cpu_seconds", "median_seconds", "set_up_seconds", "seconds",
                                           "exponent",    "half_width",     "tables",         "cheapest"};
  if (report.is_object())
    for (const std::string& key : timed) report.erase(key);
  for (Json& part : report)
    if (part.is_structured()) part = untimed(part);
  return report;
}

/// The fields of a line of CSV; commas within quotes separate nothing.
inline std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields{""};
  bool quoted = false;
  for (char c : line) {
    quoted = quoted != (c == '"');
    if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

/// A CSV file without its columns of CPU seconds, by the headings that stand above them.
inline std::string untimed_csv(const std::string& csv) {
  static const std::set<std::string> timed{"cpu_seconds", "median", "least", "most", "relative"};
  std::set<std::size_t> left_out;
  std::istringstream in(csv);
  std::string result;
  for (std::string line; std::getline(in, line);) {
    const std::vector<std::string> fields = fields_of(line);
    std::set<std::size_t> headings;
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (timed.contains(fields[i])) headings.insert(i);
    if (!headings.empty()) left_out = headings;
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (!left_out.contains(i)) result += fields[i] + ',';
    result += '\n';
  }
  return result;
}

/// A file's content as far as two runs must agree on it; of pictures with times in them that it is there.
inline std::string comparable(const std::filesystem::path& file) {
  const std::string type = file.extension();
  if (type == ".png" || type == ".svg") return "";
  return type == ".csv" ? untimed_csv(content_of(file)) : content_of(file);
}

/// Of a run's results: not what it keeps for itself, nor what it writes aside.
inline std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  if (!std::filesystem::exists(folder)) return files;
  for (const std::filesystem::directory_entry& entry :
       std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = std::filesystem::relative(entry.path(), folder);
    if (entry.is_regular_file() && name.find(".part") == std::string::npos && !name.ends_with(".journal") &&
        !name.ends_with(".checkpoint") && !name.ends_with(".kept"))
      files[name] = comparable(entry.path());
  }
  return files;
}

/// The last line of `limits` compares times.
inline std::string without_cheapest(std::string report) {
  if (const auto at = report.find("\ncheapest"); at != std::string::npos) report.erase(at);
  return report;
}

}  // namespace springstab::test
