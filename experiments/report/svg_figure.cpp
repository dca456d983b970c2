#include "experiments/report/svg_figure.h"

#include <cstdio>
#include <stdexcept>
#include <string_view>

namespace springstab {
namespace {

// As gnuplot is told them, told apart with any colour vision (after Okabe and Ito), and the same on a dark
// page.
struct PageColour {
  int light, dark;  // 0xrrggbb
};

constexpr PageColour colours[] = {
    {0xbcdcef, 0x1d4a66},  // a stable region
    {0x0a3d62, 0x9fd0f0},  // its boundary
    {0xd55e00, 0xff9a55},  // modes at the step to use
    {0x7a1f00, 0xffd0bd},  // modes at the user's step
    {0x555555, 0xb4bcc4},  // what is beside the matter
    {0xe4e4e4, 0x343c44},  // grids
    {0x0072b2, 0x62b8ec}, {0x009e73, 0x3fd0a2}, {0xcc79a7, 0xeda6cb}, {0xe69f00, 0xf2bd4c},
    {0x56b4e9, 0x9ad6f7}, {0x882255, 0xe58ab4}, {0x332288, 0xa89cf0}, {0x661100, 0xe0937f},
};

std::string property(int light) {
  char name[16];
  std::snprintf(name, sizeof name, "--c%06x", static_cast<unsigned>(light));
  return name;
}

std::string rules(int PageColour::*shade) {
  std::string all;
  for (const PageColour& colour : colours) {
    char value[16];
    std::snprintf(value, sizeof value, ":#%06x;", static_cast<unsigned>(colour.*shade));
    all += property(colour.light) + value;
  }
  return all;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

// Between `begin` and `end`, which are left out, too.
void cut(std::string& text, std::string_view begin, std::string_view end) {
  const std::size_t from = text.find(begin);
  if (from == std::string::npos) return;
  const std::size_t to = text.find(end, from);
  if (to != std::string::npos) text.erase(from, to + end.size() - from);
}

// rgb(  1,   2,   3) of a colour of the page as var(--c010203).
void set_colours(std::string& svg) {
  for (std::size_t at = 0; (at = svg.find("rgb(", at)) != std::string::npos; ++at) {
    const std::size_t end = svg.find(')', at) + 1;
    int r = 0, g = 0, b = 0;
    if (std::sscanf(svg.c_str() + at, "rgb( %d , %d , %d )", &r, &g, &b) != 3) continue;
    const int value = (r << 16) | (g << 8) | b;
    std::string named = value == 0 ? "currentColor" : "";
    for (const PageColour& colour : colours)
      if (colour.light == value) named = "var(" + property(value) + ")";
    if (!named.empty()) svg.replace(at, end - at, named);
  }
  replace_all(svg, "'black'", "'currentColor'");
  replace_all(svg, "\"black\"", "\"currentColor\"");
}

// Those of plots are repeated and not referred to, those of points and filters are within `defs`.
void set_ids(std::string& svg, const std::string& prefix) {
  for (std::size_t at = 0; (at = svg.find(" id=\"gnuplot_", at)) != std::string::npos;)
    svg.erase(at, svg.find('"', at + 5) + 1 - at);
  replace_all(svg, " id='", " id='" + prefix + "-");
  replace_all(svg, "xlink:href='#", "href='#" + prefix + "-");
  replace_all(svg, "url(#", "url(#" + prefix + "-");
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        // No document may hold other control characters.
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') out += c;
    }
  }
  return out;
}

std::string svg_figure(const std::string& svg, const std::string& prefix, const std::string& title,
                       const std::string& description) {
  const std::size_t begin = svg.find("<svg"), box = svg.find("viewBox=", begin), open = svg.find('>', box),
                    end = svg.rfind("</svg>");
  if (begin == std::string::npos || box == std::string::npos || open == std::string::npos ||
      end == std::string::npos)
    throw std::runtime_error("gnuplot drew no SVG");
  const std::string view = svg.substr(box, svg.find('"', box + 9) + 1 - box);
  std::string body = svg.substr(open + 1, end - open - 1);
  cut(body, "<title>Gnuplot", "</title>");
  cut(body, "<desc>", "</desc>");
  set_colours(body);
  set_ids(body, prefix);
  return "<svg " + view + " role=\"img\" aria-labelledby=\"" + prefix + "-title " + prefix +
         "-desc\">\n<title id=\"" + prefix + "-title\">" + escaped(title) + "</title>\n<desc id=\"" + prefix +
         "-desc\">" + escaped(description) + "</desc>\n" + body + "</svg>\n";
}

std::string page_colours() {
  return ":root{" + rules(&PageColour::light) + "}\n@media (prefers-color-scheme:dark){:root{" +
         rules(&PageColour::dark) + "}}\n";
}

}  // namespace springstab
