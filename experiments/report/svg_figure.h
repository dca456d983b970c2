// gnuplot's SVG as a part of a page: its own ids, the page's colours, a title that is read aloud.
#pragma once

#include <string>

namespace springstab {

/// Text for HTML and XML.
std::string escaped(const std::string& text);

/// Without the XML heading, with role="img", `title` and `description`. Every id begins with `prefix`, those
/// that nothing refers to are gone (gnuplot repeats them). Black is the colour of the text around it, and the
/// colours of page_colours() follow the page's theme.
std::string svg_figure(const std::string& svg, const std::string& prefix, const std::string& title,
                       const std::string& description);

/// The custom properties that it uses, as rules of CSS for a light page and, where that is preferred, for a
/// dark one.
std::string page_colours();

}  // namespace springstab
