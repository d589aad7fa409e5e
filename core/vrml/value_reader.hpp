#pragma once
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "core/vrml/arena.hpp"
#include "core/vrml/document.hpp"
#include "core/vrml/token_stream.hpp"

namespace peerd::vrml {

// A ValueReader reads the values of fields (clause 5) from tokens into an arena; those of nodes through the parser that
// owns it.
class ValueReader {
 public:
  ValueReader(TokenStream& tokens, Arena& arena, Problems& problems)
      : tokens_(tokens), arena_(arena), problems_(problems) {}

  // Reads one node of an SFNode or MFNode value: null where it could not be read, nothing where a ROUTE or PROTO stood.
  using ReadNode = std::function<std::optional<NodeRef>(const FieldSpec&)>;
  // Returns whether a word among the values of a list shows that the ']' of the list was forgotten: it is the next
  // field of the node.
  using IsField = std::function<bool(std::string_view)>;
  void set_parser(ReadNode read_node, IsField is_field) {
    read_node_ = std::move(read_node);
    is_field_ = std::move(is_field);
  }

  // Returns the value of a field of that type, checked against its range; reports mistakes in it and then returns
  // nothing. Without `check`, the range is left to the caller.
  [[nodiscard]] std::optional<Field> read(const FieldSpec& spec, bool check = true);

  // Passes over a value whose type is not known. Nodes in it are read, to find mistakes in them and their names.
  // Returns the names that were DEFed in the parts that were passed over unread.
  std::vector<std::string_view> skip(bool in_list = false);
  [[nodiscard]] bool in_list() const { return open_lists_ > 0; }

 private:
  [[nodiscard]] std::optional<Field> read_unbracketed(const FieldSpec& spec, bool check);
  template <class ReadOne>
  bool read_list(ReadOne read_one);
  template <class T>
  bool read_numbers(const FieldSpec& spec, Field& field);
  template <class T>
  bool read_single(const FieldSpec& spec, Field& field);
  template <class T>
  bool read_several(const FieldSpec& spec, Field& field);
  bool read_floats(const FieldSpec& spec, Field& field);
  bool read_image(const FieldSpec& spec, Field& field);
  bool read_one_node(const FieldSpec& spec, Field& field);
  bool read_nodes(const FieldSpec& spec, Field& field);
  void check_axes(const FieldSpec& spec, const Field& field);

  bool read_one(const FieldSpec& spec, float& value);
  bool read_one(const FieldSpec& spec, std::int32_t& value);
  bool read_one(const FieldSpec& spec, double& value);
  bool read_one(const FieldSpec& spec, bool& value);
  bool read_one(const FieldSpec& spec, std::string_view& value);
  template <class T>
  bool take_number(const FieldSpec& spec, std::expected<T, NumberError> number, T& value);
  template <class T>
  bool read_on_from(const FieldSpec& spec, NumberError error, T& value);
  bool expected_value(const FieldSpec& spec, std::string_view what);
  // Returns whether the list that began at `open` ends here, well or not; `good` says which.
  bool list_ends(const Token& open, bool& good);
  [[nodiscard]] bool at_next_field();

  template <class T>
  void keep(Field& field, std::span<const T> elements) {
    const auto kept = arena_.copy(elements);
    field.data = kept.data();
    field.count = static_cast<std::uint32_t>(kept.size());
  }

  TokenStream& tokens_;
  Arena& arena_;
  Problems& problems_;
  ReadNode read_node_;
  IsField is_field_;
  std::vector<NodeRef> refs_;  // nodes of all open lists
  std::uint32_t open_lists_ = 0;
};

}  // namespace peerd::vrml
