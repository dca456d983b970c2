#include "experiments/report/page.h"

#include "experiments/report/svg_figure.h"

namespace springstab {
namespace {

// Sizes in rem, so that it grows with the reader's text; contrasts of at least 4.5 in both themes.
constexpr char style[] = R"(
:root{color-scheme:light dark;--ink:#1b2126;--paper:#ffffff;--soft:#525b64;--line:#d4d9de;--panel:#f3f6f8;
--good:#0a5c40;--warn:#8a4600;--accent:#0a3d62}
@media (prefers-color-scheme:dark){:root{--ink:#e6eaee;--paper:#15191d;--soft:#aab4be;--line:#39424b;--panel:#1f252b;
--good:#6fd6ae;--warn:#ffb877;--accent:#9fd0f0}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:64rem;padding:1.5rem 1.25rem 4rem;background:var(--paper);color:var(--ink);
font:1rem/1.55 system-ui,"DejaVu Sans",sans-serif}
h1{font-size:1.6rem;line-height:1.25;margin:0 0 .25rem;overflow-wrap:anywhere}
h2{font-size:1.2rem;margin:2.4rem 0 .6rem;padding-top:.9rem;border-top:1px solid var(--line)}
p{margin:.5rem 0;max-width:46rem}
.answer{font-size:1.2rem;max-width:none;padding:1rem 1.2rem;margin:1rem 0;background:var(--panel);
border-left:.3rem solid var(--accent);border-radius:.25rem}
.note,figcaption,caption{color:var(--soft);font-size:.92rem}
.warnings{padding:.7rem 1rem .7rem 2rem;margin:.8rem 0;border:1px solid var(--warn);border-radius:.25rem;color:var(--warn)}
nav ul{list-style:none;display:flex;flex-wrap:wrap;gap:.3rem 1.1rem;padding:0;margin:.8rem 0 0;font-size:.95rem}
a{color:var(--accent)}
a:focus-visible,summary:focus-visible,[tabindex]:focus-visible{outline:.16rem solid var(--accent);outline-offset:.15rem}
.scroll{overflow-x:auto;margin:.8rem 0}
table{border-collapse:collapse;font-size:.93rem;font-variant-numeric:tabular-nums}
caption{text-align:left;padding-bottom:.4rem}
th,td{padding:.32rem .8rem .32rem 0;border-bottom:1px solid var(--line);text-align:left;vertical-align:top}
thead th{color:var(--soft);font-weight:600;vertical-align:bottom}
tbody th{font-weight:600;white-space:nowrap}
.numbers td{white-space:nowrap}
.numbers td,.numbers thead th:not(:first-child){text-align:right}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.25rem 1.4rem;margin:.6rem 0}
dt{color:var(--soft)}
dd{margin:0;overflow-wrap:anywhere}
figure{margin:1rem 0}
.pictures{display:flex;flex-wrap:wrap;gap:1rem}
.pictures>*{flex:1 1 22rem;min-width:0;max-width:100%;height:auto}
.pictures>img{max-height:30rem;object-fit:contain}
svg text{font-family:system-ui,"DejaVu Sans",sans-serif}
pre{overflow-x:auto;padding:.8rem 1rem;background:var(--panel);border-radius:.25rem;font-size:.88rem;line-height:1.45}
code,pre{font-family:ui-monospace,"DejaVu Sans Mono",monospace}
details summary{cursor:pointer;color:var(--accent)}
@media print{body{max-width:none;padding:0}h2,figure,tr{break-inside:avoid}h2{break-after:avoid}nav{display:none}}
)";

std::string base64(const std::string& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j)
      out += i + j <= bytes.size() ? digits[group >> (18 - 6 * j) & 63] : '=';
  }
  return out;
}

std::string class_of(const std::string& kind) { return kind.empty() ? "" : " class=\"" + kind + '"'; }

}  // namespace

std::string data_url(const std::string& type, const std::string& bytes) {
  return "data:" + type + ";base64," + base64(bytes);
}

std::string png_image(const std::string& png, const std::string& description) {
  return "<img src=\"" + data_url("image/png", png) + "\" alt=\"" + escaped(description) + "\"/>\n";
}

Page::Page(const std::string& title, const std::string& answer) {
  out_ << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
          "<link rel=\"icon\" href=\"data:,\"/>\n<title>"
       << escaped(title) << "</title>\n<style>" << style << page_colours()
       << "</style>\n</head>\n<body>\n<header>\n<h1>" << escaped(title) << "</h1>\n<p class=\"answer\">"
       << escaped(answer) << "</p>\n</header>\n<main>\n";
}

void Page::end_section() {
  if (in_section_) out_ << "</section>\n";
  in_section_ = false;
}

void Page::section(const std::string& id, const std::string& heading) {
  end_section();
  in_section_ = true;
  out_ << "<section aria-labelledby=\"" << id << "\">\n<h2 id=\"" << id << "\">" << escaped(heading)
       << "</h2>\n";
}

void Page::paragraph(const std::string& text, const std::string& kind) {
  out_ << "<p" << class_of(kind) << '>' << escaped(text) << "</p>\n";
}

void Page::list(const std::vector<std::string>& items, const std::string& kind) {
  if (items.empty()) return;
  out_ << "<ul" << class_of(kind) << ">\n";
  for (const std::string& item : items) out_ << "<li>" << escaped(item) << "</li>\n";
  out_ << "</ul>\n";
}

void Page::preformatted(const std::string& text) {
  out_ << "<pre tabindex=\"0\"><code>" << escaped(text) << "</code></pre>\n";
}

void Page::folded_text(const std::string& summary, const std::string& text) {
  out_ << "<details>\n<summary>" << escaped(summary) << "</summary>\n";
  preformatted(text);
  out_ << "</details>\n";
}

void Page::facts(const std::vector<std::pair<std::string, std::string>>& all) {
  out_ << "<dl>\n";
  for (const auto& [name, value] : all)
    if (!value.empty()) out_ << "<dt>" << escaped(name) << "</dt><dd>" << escaped(value) << "</dd>\n";
  out_ << "</dl>\n";
}

void Page::table(const std::string& caption, const std::vector<std::string>& headings,
                 const std::vector<std::vector<std::string>>& rows, bool numbers) {
  out_ << "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" << escaped(caption)
       << "\">\n<table" << class_of(numbers ? "numbers" : "") << ">\n<caption>" << escaped(caption)
       << "</caption>\n<thead><tr>";
  for (const std::string& heading : headings) out_ << "<th scope=\"col\">" << escaped(heading) << "</th>";
  out_ << "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : rows) {
    out_ << "<tr><th scope=\"row\">" << escaped(row[0]) << "</th>";
    for (std::size_t i = 1; i < row.size(); ++i) out_ << "<td>" << escaped(row[i]) << "</td>";
    out_ << "</tr>\n";
  }
  out_ << "</tbody>\n</table>\n</div>\n";
}

void Page::figure(const std::vector<std::string>& pictures, const std::string& caption) {
  out_ << "<figure>\n<div class=\"pictures\">\n";
  for (const std::string& picture : pictures) out_ << picture;
  out_ << "</div>\n<figcaption>" << escaped(caption) << "</figcaption>\n</figure>\n";
}

// What would end the element, or be read as markup, is written as JSON writes any character.
void Page::json(const std::string& id, const std::string& document) {
  out_ << "<script type=\"application/json\" id=\"" << id << "\">";
  for (const char c : document) {
    if (c == '<' || c == '>' || c == '&')
      out_ << (c == '<' ? "\\u003c" : c == '>' ? "\\u003e" : "\\u0026");
    else
      out_ << c;
  }
  out_ << "</script>\n";
}

std::string Page::text() {
  end_section();
  return out_.str() + "</main>\n</body>\n</html>\n";
}

}  // namespace springstab
