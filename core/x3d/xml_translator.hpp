#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/vrml/node_types.hpp"
#include "core/x3d/classic_writer.hpp"

namespace peerd::vrml {

// An XmlTranslator writes the elements of X3D as the nodes and statements that they are in the Classic VRML encoding.
// It decides what XML leaves open: where a field's value ends, and which field of the node around it a node belongs to.
class XmlTranslator {
 public:
  // The tree that is translated points into `copy`, which has the bytes of the text at `begin`.
  XmlTranslator(const char* copy, Position begin, Problems& problems) : writer_(begin, problems), copy_(copy) {}

  [[nodiscard]] ClassicText translate(pugi::xml_node root);

 private:
  using Element = pugi::xml_node;

  // The type of an element that is a node, as far as it says what stands in it.
  struct Type {
    const NodeType* built_in = nullptr;
    const std::map<std::string_view, std::string_view>* interface = nullptr;  // types of fields, of a PROTO
  };
  struct Proto {
    std::map<std::string_view, std::string_view> fields;  // their types
    std::string_view container = "children";              // of its first node
  };
  // The names of a file or of a ProtoBody.
  struct Scope {
    std::map<std::string_view, Proto> protos;
    std::map<std::string_view, Element> left_out;  // nodes that stand in others that are left out, by their DEFs
  };
  // The elements of one field, in order, or one statement.
  struct Part {
    std::string_view field;  // empty for a statement
    std::vector<Element> elements;
  };
  // The connect of a field of a node.
  struct Link {
    std::string_view proto_field;
    std::size_t at = 0;
    bool written = false;
  };
  using Links = std::map<std::string_view, Link>;

  void head(Element head);
  void content(Element around);  // of a Scene or a ProtoBody
  // Writes a statement if the element is one, and says whether it is.
  bool statement(Element element);
  void route(Element element);
  void import_or_export(Element element);
  void proto(Element element);
  void extern_proto(Element element);
  void interface(Element around, bool with_values, Proto& proto);
  void declaration(Element field, bool with_values, Links* links);
  void declared_value(Element field, std::string_view type);

  void node(Element element);
  void use(Element element);
  void names_in(Element element);  // of a node that is left out
  void fields(Element element, const Type& type);
  void attributes(Element element, const Type& type, std::string_view& url, std::size_t& url_at);
  void attribute(pugi::xml_attribute attribute, const Type& type);
  void children(Element element, const Type& type);
  void part(const Part& part, const Type& type);
  void field_value(Element element, const Type& type);
  void script_url(Element element, std::string_view url, std::size_t url_at);
  void write(const Links& links);
  [[nodiscard]] Links links_of(Element element);

  // Returns whether the reader keeps a field of nodes of a node of that type.
  [[nodiscard]] static bool keeps(const Type& type, std::string_view field);
  [[nodiscard]] const Proto* find_proto(std::string_view name) const;
  // Returns the type of a field as X3D names it; nothing where the node has no such field.
  [[nodiscard]] static std::optional<std::string_view> field_type(const Type& type, std::string_view field);
  [[nodiscard]] std::string_view container_of_element(Element element, const Type& around) const;
  // Returns the value of an attribute that an element must have; reports its lack.
  std::optional<pugi::xml_attribute> wanted(Element element, const char* name);
  bool enter(Element element);  // false where elements nest too deep, which it reports
  [[nodiscard]] std::size_t at(Element element) const;
  [[nodiscard]] std::size_t at(pugi::xml_attribute attribute) const;

  ClassicWriter writer_;
  const char* copy_;
  std::vector<Scope> scopes_{1};  // of the file and of each open ProtoBody
  bool left_out_around_ = false;  // what is written stands in a field that the reader passes over
  std::uint32_t depth_ = 0;
  bool too_deep_ = false;
};

}  // namespace peerd::vrml
