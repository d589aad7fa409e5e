#include "core/vrml/default_values.hpp"

#include <unordered_map>

#include "core/vrml/value_reader.hpp"

namespace peerd::vrml {
namespace {

// The table's default values, read once from its texts.
class Defaults {
 public:
  Defaults() {
    for (const NodeType& type : node_types()) {
      for (const FieldSpec& spec : type.fields) {
        if (spec.access == Access::kEventIn || spec.access == Access::kEventOut) continue;
        Problems problems;
        const Position begin = problems.open({"", spec.default_value, nullptr}).value();
        TokenStream tokens(spec.default_value, begin, 0, problems);
        const std::optional<Field> value = ValueReader(tokens, arena_, problems).read(spec, false);
        assert(value && problems.errors() == 0 && "a default in the table does not parse");
        fields_.emplace(&spec, *value);
      }
    }
  }
  [[nodiscard]] const Field& of(const FieldSpec& spec) const { return fields_.at(&spec); }

 private:
  Arena arena_;
  std::unordered_map<const FieldSpec*, Field> fields_;
};

}  // namespace

const Field& default_of(const FieldSpec& spec) {
  static const Defaults defaults;
  return defaults.of(spec);
}

const Field& value_of(const Node& node, std::string_view field) {
  if (const Field* given = node.find(field)) return *given;
  const FieldSpec* spec = find_field(*node.type, field);
  assert(spec != nullptr);
  return default_of(*spec);
}

}  // namespace peerd::vrml
