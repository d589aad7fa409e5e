#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace peerd::report::testing_support {

// The reason why a text is not well-formed XML of the simple kind that we write; nullopt if it is.
inline std::optional<std::string> malformed(const std::string& xml) {
  std::vector<std::string> open;
  std::size_t at = 0;
  while ((at = xml.find('<', at)) != std::string::npos) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return "unclosed tag at " + std::to_string(at);
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.find('<') != std::string::npos) return "'<' in tag " + tag;
    if (std::ranges::count(tag, '"') % 2 != 0) return "odd quotes in tag " + tag;
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag.front() == '/') {
      if (open.empty() || "/" + open.back() != tag) return "unexpected " + tag;
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
    at = end;
  }
  for (at = 0; (at = xml.find('&', at)) != std::string::npos; ++at) {
    const std::string entity = xml.substr(at, xml.find(';', at) - at);
    if (entity != "&amp" && entity != "&lt" && entity != "&gt" && entity != "&quot")
      return "bare & at " + std::to_string(at);
  }
  for (const char* bad : {"nan", "inf"}) {
    if (xml.find(std::string("\"") + bad) != std::string::npos) return std::string("a number is ") + bad;
  }
  if (!open.empty()) return "unclosed " + open.back();
  return xml.starts_with("<svg ") ? std::nullopt : std::optional<std::string>("no svg element");
}

// Counts the occurrences of `part` in `text`.
inline std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace peerd::report::testing_support
