#pragma once
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/vrml/document.hpp"

namespace peerd::formats {

// A NodeDraft is a node of a document while its fields are given, for readers whose files are no VRML text. The values
// must be ones that the field may have: nothing is checked here.
class NodeDraft {
 public:
  // `at` is the place in the file that the node and its fields are reported at.
  NodeDraft(vrml::Document& document, std::string_view type, vrml::Position at);

  NodeDraft& named(std::string_view def);  // nothing where it is empty
  NodeDraft& floats(std::string_view field, std::span<const float> values);
  NodeDraft& floats(std::string_view field, std::initializer_list<float> values);
  // Both take an array as it is, without copying it.
  NodeDraft& floats(std::string_view field, std::vector<float>&& values);
  NodeDraft& integers(std::string_view field, std::vector<std::int32_t>&& values);
  // Takes an array that another node of the document has, too.
  NodeDraft& shared_integers(std::string_view field, std::span<const std::int32_t> values);
  [[nodiscard]] std::span<const std::int32_t> last_integers() const;  // the value that was given last
  NodeDraft& integer(std::string_view field, std::int32_t value);
  NodeDraft& flag(std::string_view field, bool value);
  NodeDraft& time(std::string_view field, double value);
  NodeDraft& strings(std::string_view field, std::span<const std::string_view> values);
  NodeDraft& string(std::string_view field, std::string_view value);
  NodeDraft& nodes(std::string_view field, std::span<const vrml::NodeRef> refs);
  NodeDraft& node(std::string_view field, vrml::NodeRef ref);  // nothing where it is none

  // Replaces the fields of a node of that type by these.
  void give_to(vrml::Node& node);
  // Adds the node to the document, behind all nodes that it refers to.
  vrml::NodeRef add();

 private:
  template <class T>
  NodeDraft& keep(std::string_view field, std::span<const T> values);
  template <class T>
  NodeDraft& adopt(std::string_view field, std::vector<T>&& values);
  void set(std::string_view field, const void* data, std::size_t count);

  vrml::Document& document_;
  vrml::Node node_;
  std::vector<vrml::Field> fields_;
};

}  // namespace peerd::formats
