#include "core/x3d/xml_reader.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <utility>

#include "core/x3d/xml_translator.hpp"

namespace peerd::vrml {
namespace {

constexpr std::size_t kMostClassicBytes = std::size_t{3} << 30;  // offsets are 32 bits wide

// A sentence about a text, and the offset that it is about.
struct XmlFault {
  std::size_t at = 0;
  std::string why;
};

// The library takes bytes that no XML may contain, and keeps 64 bytes for an element and 40 for an attribute, which
// need no more than 4 and 5 of the text. So a text is looked through before the library has it.
std::optional<XmlFault> fault_before_parsing(std::string_view xml, const ReadLimits& limits) {
  constexpr std::uint64_t kElementBytes = 64, kAttributeBytes = 40, kBase = std::uint64_t{1} << 24, kPerByte = 8;
  constexpr std::size_t kMost = std::size_t{1} << 30;
  if (xml.size() > kMost) return XmlFault{0, "this X3D is larger than 1 GiB, more than this reader takes"};
  std::uint64_t elements = 0, attributes = 0;
  for (std::size_t i = 0; i < xml.size(); ++i) {
    const auto c = static_cast<unsigned char>(xml[i]);
    if (c < 0x20 && c != '\t' && c != '\n' && c != '\r') return XmlFault{i, "no XML contains this byte"};
    if (c == '<' && i + 1 < xml.size() && xml[i + 1] != '/') ++elements;
    if (c == '=') ++attributes;
  }
  const std::uint64_t most = limits.expansion * (kBase + kPerByte * xml.size());
  if (kElementBytes * elements + kAttributeBytes * attributes > most) {
    return XmlFault{0, "there are more elements than a file of this size may have" + std::string(ReadLimits::kRaised)};
  }
  return std::nullopt;
}

bool is_utf8(pugi::xml_node declaration) {
  std::string encoding(declaration.attribute("encoding").as_string("utf-8"));
  std::ranges::transform(encoding, encoding.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; });
  return encoding == "utf-8" || encoding == "us-ascii" || encoding == "ascii";
}

}  // namespace

ClassicText classic_of_xml(Position begin, Problems& problems, const ReadLimits& limits) {
  const std::string_view xml = problems.text_of(begin);
  const auto fail = [&](std::size_t at, std::string why) {
    problems.error(begin + static_cast<Position>(std::min(at, xml.size())), std::move(why));
    return ClassicText{};
  };
  if (auto fault = fault_before_parsing(xml, limits)) return fail(fault->at, std::move(fault->why));
  // The tree points into this copy. Nothing in it is decoded, so that each byte stays where it stands in the text.
  std::string copy(xml);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer_inplace(
      copy.data(), copy.size(), pugi::parse_cdata | pugi::parse_declaration | pugi::parse_doctype, pugi::encoding_utf8);
  if (!parsed) {
    std::string why(parsed.description());
    if (!why.empty() && why.front() >= 'A' && why.front() <= 'Z')
      why.front() = static_cast<char>(why.front() + ('a' - 'A'));
    return fail(static_cast<std::size_t>(parsed.offset), "this is no well-formed XML: " + why);
  }
  for (const pugi::xml_node node : document.children()) {
    const auto at = static_cast<std::size_t>(node.offset_debug());
    if (node.type() == pugi::node_declaration && !is_utf8(node)) {
      return fail(at,
                  "the encoding of this XML is " + quoted(node.attribute("encoding").value()) + "; only UTF-8 is read");
    }
    if (node.type() == pugi::node_element && node != document.document_element()) {
      return fail(at, "this is no well-formed XML: there is a second root, " + quoted(node.name()));
    }
  }
  const pugi::xml_node root = document.document_element();
  if (std::string_view(root.name()) != "X3D") {
    return fail(static_cast<std::size_t>(root.offset_debug()),
                "this XML is no X3D: its root is " + quoted(root.name()) + ", and not 'X3D'");
  }
  ClassicText classic = XmlTranslator(copy.data(), begin, problems).translate(root);
  if (classic.text.size() > kMostClassicBytes) return fail(0, "this X3D says too much for this reader");
  return classic;
}

}  // namespace peerd::vrml
