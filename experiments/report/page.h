// The page of a report: HTML with its style in it, well-formed as XML, too, which asks for nothing elsewhere.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace springstab {

/// The bytes as a data: URL.
std::string data_url(const std::string& type, const std::string& bytes);

class Page {
 public:
  Page(const std::string& title, const std::string& answer);

  void section(const std::string& id, const std::string& heading);
  /// Text, which is escaped here, as everywhere.
  void paragraph(const std::string& text, const std::string& kind = "");
  void list(const std::vector<std::string>& items, const std::string& kind);
  void preformatted(const std::string& text);
  /// Closed until it is opened.
  void folded_text(const std::string& summary, const std::string& text);
  /// Pairs of a name and a value.
  void facts(const std::vector<std::pair<std::string, std::string>>& all);
  /// The first column is headings of rows; the others are numbers where `numbers` is set.
  void table(const std::string& caption, const std::vector<std::string>& headings,
             const std::vector<std::vector<std::string>>& rows, bool numbers = true);
  /// SVG parts as svg_figure() makes them, or images, side by side.
  void figure(const std::vector<std::string>& pictures, const std::string& caption);
  /// A document for programs.
  void json(const std::string& id, const std::string& document);

  std::string text();

 private:
  void end_section();

  std::ostringstream out_;
  bool in_section_ = false;
};

/// An image of a page, by its bytes.
std::string png_image(const std::string& png, const std::string& description);

}  // namespace springstab
