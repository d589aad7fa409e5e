#include "core/vrml/field_checks.hpp"

#include <optional>
#include <string>

#include "core/vrml/element_positions.hpp"

namespace peerd::vrml {

bool check_nodes(const FieldSpec& spec, const Field& value, const std::vector<Node>& nodes, Problems& problems) {
  if (!holds_nodes(spec.type)) return true;
  bool good = true;
  for (const NodeRef& ref : value.as<NodeRef>()) {
    if (!ref.is_node()) continue;
    const NodeType& type = *nodes[ref.index].type;
    if ((spec.accepts & type.classes) != 0) continue;
    std::string message = quoted(spec.name) + " takes " + std::string(name_of_classes(spec.accepts)) + "; " +
                          std::string(type.name) + " is " + std::string(name_of_classes(type.classes));
    if (spec.accepts == kChild) {
      // A node that is no child is neither shown nor solid there, and harmless.
      if (type.classes == kGeometry) message += ": write Shape { geometry " + std::string(type.name) + " { .. } }";
      problems.warning(ref.at, message + "; here it has no effect");
      continue;
    }
    problems.fault(ref.at, message, "the node is left out there");
    good = false;
  }
  return good;
}

bool check_range(const FieldSpec& spec, const Field& value, Problems& problems) {
  if (spec.range == Range::kAny) return true;
  const bool positive =
      spec.range == Range::kPositive || spec.range == Range::kShouldBePositive || spec.range == Range::kSize;
  const bool must = spec.range == Range::kPositive || spec.range == Range::kNonNegative || spec.range == Range::kSize;
  bool good = true;
  std::optional<ElementPositions> positions;
  const auto check = [&](std::size_t element, double number) {
    if (positive ? number > 0 : number >= 0) return;
    if (problems.full()) return;
    if (!positions) positions.emplace(problems.text_of(value.at), problems.begin_of(value.at), value.at);
    const bool is_error = must && !(spec.range == Range::kSize && number == 0);
    const std::string found = ", found " + quoted(positions->text_at(element));
    const Position at = positions->at(element);
    if (is_error) {
      problems.fault(at, quoted(spec.name) + (positive ? " must be > 0" : " must be >= 0") + found,
                     "the field has its default value");
      good = false;
    } else {
      problems.warning(
          at, quoted(spec.name) + (positive ? " should be > 0" : " should be >= 0") + found + "; it is taken as it is");
    }
  };
  if (float_count(spec.type) > 0) {
    for (std::size_t i = 0; i < value.count; ++i) check(i, static_cast<double>(value.as<float>()[i]));
  } else if (spec.type == FieldType::kSFInt32 || spec.type == FieldType::kMFInt32) {
    for (std::size_t i = 0; i < value.count; ++i) check(i, value.as<std::int32_t>()[i]);
  } else if (spec.type == FieldType::kSFTime || spec.type == FieldType::kMFTime) {
    for (std::size_t i = 0; i < value.count; ++i) check(i, value.as<double>()[i]);
  }
  return good;
}

}  // namespace peerd::vrml
