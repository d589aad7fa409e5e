#include "peerd/lab/report/page_frame.hpp"

#include "peerd/input/json_text.hpp"
#include "peerd/lab/report/markup.hpp"

namespace peerd::report {
std::string element(std::string_view tag, std::string_view content) {
  std::string out = "<";
  out.append(tag).append(">").append(content).append("</").append(tag.substr(0, tag.find(' '))).append(">");
  return out;
}

std::string data_element(std::string_view name, const Json& data) {
  std::string text;
  for (const char c : json_line(data)) {
    if (c == '<') {
      text += "\\u003c";  // no text of the data ends the element
    } else {
      text += c;
    }
  }
  return element("script class=\"" + std::string(name) + "\" type=\"application/json\"", text);
}

std::string figure_markup(const Json& figure, std::string_view name, std::string_view caption) {
  return element("figure data-name=\"" + std::string(name) + '"',
                 data_element("figure", figure) + element("figcaption", caption)) +
         '\n';
}

std::string page_around(std::string_view title, std::string_view body) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n";
  out += element("title", markup_text(title)) + '\n' + element("style", kPageStyle) + "\n</head>\n<body>\n";
  out += element("noscript", element("p", "The figures of this page are drawn by its script."));
  return out.append(body) + element("script", kPageScript) + "\n</body>\n</html>\n";
}

}  // namespace peerd::report
