#include "core/vrml/default_values.hpp"

#include <array>
#include <cassert>
#include <cstddef>
#include <optional>
#include <unordered_map>

#include "core/vrml/value_reader.hpp"

namespace peerd::vrml {
namespace {

// Defaults are the default values of the table of node types, read once from its texts.
class Defaults {
 public:
  Defaults() {
    for (const NodeType& type : node_types()) {
      for (const FieldSpec& spec : type.fields) {
        if (spec.access == Access::kEventIn || spec.access == Access::kEventOut) continue;
        read(spec);
      }
    }
    for (std::size_t type = 0; type < declared_.size(); ++type) {
      declared_[type] = {"", static_cast<FieldType>(type), Access::kField,
                         default_text_of(static_cast<FieldType>(type))};
      read(declared_[type]);
    }
  }
  [[nodiscard]] const Field& of(const FieldSpec& spec) const { return fields_.at(&spec); }
  [[nodiscard]] const Field& of(FieldType type) const { return of(declared_[static_cast<std::size_t>(type)]); }

 private:
  void read(const FieldSpec& spec) {
    Problems problems;
    const Position begin = problems.open({"", spec.default_value, nullptr}).value();
    TokenStream tokens(spec.default_value, begin, 0, problems);
    const std::optional<Field> value = ValueReader(tokens, arena_, problems).read(spec, false);
    assert(value && problems.errors() == 0 && "a default in the table does not parse");
    fields_.emplace(&spec, *value);
  }

  Arena arena_;
  std::array<FieldSpec, static_cast<std::size_t>(FieldType::kMFVec3f) + 1> declared_{};  // a field of each type
  std::unordered_map<const FieldSpec*, Field> fields_;
};

const Defaults& defaults() {
  static const Defaults all;
  return all;
}

}  // namespace

const Field& default_of(const FieldSpec& spec) { return defaults().of(spec); }
const Field& default_of(FieldType type) { return defaults().of(type); }

const Field& value_of(const Node& node, std::string_view field) {
  if (const Field* given = node.find(field)) return *given;
  const FieldSpec* spec = find_field(*node.type, field);
  assert(spec != nullptr);
  return default_of(*spec);
}

}  // namespace peerd::vrml
