// The elements of an XML file, found by Expat: a list, with the lines that errors must name. A packaged
// parser, because XML has more corners than its look suggests; this one, because it knows lines and bytes,
// stops where what is behind is no XML any more (VTK's appended data), and takes nothing but memory in
// proportion to the file.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/io/text_file.h"

namespace springstab {

struct XmlElement {
  std::string name;
  std::map<std::string, std::string, std::less<>> attributes;
  int parent;             // in the list; -1 of the outermost
  std::string_view text;  // up to the first element within it that has text before, of the file
  Location at, text_at;   // where it and its text begin

  /// An attribute, or what it is where it is absent.
  std::string_view attribute(std::string_view key, std::string_view otherwise = "") const;
};

struct XmlFile {
  std::vector<XmlElement> elements;  // in the order in which they begin
  std::string_view rest;             // behind the tag of the element at which reading stopped
};

/// Whether this program was built with Expat.
bool has_expat();

/// Source and text must outlive what it returns. Throws InputError, with the line, where there is no
/// well-formed XML up to the first element of the name `last` or to the end, and where this program was built
/// without Expat. A document type, which may define what the text means, is refused.
XmlFile read_xml(std::string_view source, std::string_view text, const std::string& last);

}  // namespace springstab
