#include "solvers/io/xml_file.h"

#include <algorithm>
#include <memory>
#include <type_traits>

#ifdef SPRINGSTAB_EXPAT
#include <expat.h>
#endif

namespace springstab {

std::string_view XmlElement::attribute(std::string_view key, std::string_view otherwise) const {
  const auto found = attributes.find(key);
  return found == attributes.end() ? otherwise : std::string_view(found->second);
}

#ifdef SPRINGSTAB_EXPAT
bool has_expat() { return true; }

namespace {

class XmlReader {
 public:
  XmlReader(std::string_view source, std::string_view text, const std::string& last)
      : source_(source), text_(text), last_(last), parser_(XML_ParserCreate(nullptr), XML_ParserFree) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const char* name, const char** pairs) {
          static_cast<XmlReader*>(self)->begin(name, pairs);
        },
        [](void* self, const char*) { static_cast<XmlReader*>(self)->end(); });
    XML_SetStartDoctypeDeclHandler(parser_.get(), [](void* self, const char*, const char*, const char*, int) {
      static_cast<XmlReader*>(self)->stop("a document type, expected none");
    });
  }

  XmlFile read() {
    const auto size = static_cast<int>(text_.size());
    if (XML_Parse(parser_.get(), text_.data(), size, XML_TRUE) == XML_STATUS_ERROR) {
      const XML_Error error = XML_GetErrorCode(parser_.get());
      if (error != XML_ERROR_ABORTED)
        at().fail(std::string("this is no XML (") + XML_ErrorString(error) + "), expected elements that end");
      if (!wrong_.empty()) wrong_at_.fail(wrong_);
    }
    return std::move(file_);
  }

 private:
  Location at() const { return {source_, static_cast<long>(XML_GetCurrentLineNumber(parser_.get()))}; }

  /// No exception may go through the parser, which is C.
  void stop(const std::string& what) {
    wrong_ = what;
    wrong_at_ = at();
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  std::size_t position() const {
    return std::min(static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_.get())), text_.size());
  }

  void begin(const char* name, const char** pairs) {
    close_text();
    XmlElement element{name, {}, open_.empty() ? -1 : open_.back(), {}, at(), {}};
    for (; *pairs; pairs += 2) element.attributes[pairs[0]] = pairs[1];
    open_.push_back(static_cast<int>(file_.elements.size()));
    file_.elements.push_back(std::move(element));
    open_text();
    if (name != last_) return;
    file_.rest = text_.substr(text_begin_);
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  void end() {
    close_text();
    open_.pop_back();
    open_text();
  }

  /// Text goes from behind one tag to the next.
  void open_text() {
    text_begin_ =
        std::min(position() + static_cast<std::size_t>(XML_GetCurrentByteCount(parser_.get())), text_.size());
    const std::string_view tag = text_.substr(position(), text_begin_ - position());
    text_at_ = {source_, at().line + std::ranges::count(tag, '\n')};
  }
  void close_text() {
    if (open_.empty() || position() < text_begin_) return;
    XmlElement& element = file_.elements[static_cast<std::size_t>(open_.back())];
    const std::string_view text = text_.substr(text_begin_, position() - text_begin_);
    if (text.find_first_not_of(" \t\r\n") == text.npos) return;
    if (!element.text.empty())
      return stop("more text behind an element within the text, expected all of it before");
    element.text = text;
    element.text_at = text_at_;
  }

  std::string_view source_, text_;
  const std::string& last_;
  std::unique_ptr<std::remove_pointer_t<XML_Parser>, void (*)(XML_Parser)> parser_;
  XmlFile file_;
  std::vector<int> open_;
  std::size_t text_begin_ = 0;
  Location text_at_;
  std::string wrong_;
  Location wrong_at_;
};

}  // namespace

XmlFile read_xml(std::string_view source, std::string_view text, const std::string& last) {
  if (text.ends_with('\x1a')) text.remove_suffix(1);  // how DOS ends a file
  return XmlReader(source, text, last).read();
}
#else
bool has_expat() { return false; }

XmlFile read_xml(std::string_view source, std::string_view, const std::string&) {
  Location{source}.fail(
      "is XML, which this program was built without, expected one built with Expat (Debian: libexpat1-dev)");
}
#endif

}  // namespace springstab
