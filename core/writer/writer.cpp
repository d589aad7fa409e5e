#include "core/writer/writer.hpp"

#include <cassert>

#include "core/animation/file_times.hpp"
#include "core/writer/text_writer.hpp"
#include "core/writer/write_plan.hpp"

namespace peerd {
namespace vrml {
namespace {

// The Writer takes the walk of the plan again, writing.
class Writer {
 public:
  Writer(const Document& document, const WritePlan& plan)
      : document_(document), plan_(plan), visited_(document.nodes.size(), false) {}

  std::string write();

 private:
  using RefAction = WritePlan::RefAction;

  void declare(const NodeType& type, std::string_view name);
  void item(const NodeRef& ref, std::uint32_t holder);
  void node(std::uint32_t index);
  void field(const WrittenField& field, std::uint32_t holder);
  void nodes(const Field* value, const FieldSpec& spec, std::uint32_t holder);
  void paths(const Node& node, const Field& value);
  void route(std::uint32_t route);
  void place() {
    for (const std::uint32_t r : plan_.routes_at(place_++)) route(r);
  }

  const Document& document_;
  const WritePlan& plan_;
  std::vector<bool> visited_;
  std::uint32_t place_ = 0;
  TextWriter out_;
};

std::string Writer::write() {
  out_.line("#VRML V2.0 utf8");
  if (needs_world_times(document_) && !has_world_times(document_)) {
    out_.begin_line("WorldInfo ");
    out_.open("{");
    out_.line("worldTimes TRUE");
    out_.close("}");
  }
  for (const NodeType* type : plan_.external_types()) {
    Node instance;
    instance.type = type;
    declare(*type, plan_.type_name_of(instance));
  }
  const auto top_level = [&](const NodeRef& ref) {
    out_.begin_line({});
    item(ref, NodeRef::kNull);
    place();
  };
  for (const NodeRef& ref : document_.top_level) top_level(ref);
  for (const std::uint32_t index : plan_.outside().plain) top_level({index});
  if (const auto& held = plan_.outside().held; !held.empty()) {
    out_.begin_line("Script ");
    out_.open("{");
    out_.begin_line("field MFNode ");
    out_.add(kHolderField);
    out_.open(" [");
    for (const std::uint32_t index : held) {
      out_.begin_line({});
      item({index}, NodeRef::kNull);
    }
    out_.close("]");
    out_.close("}");
    place();
  }
  for (const std::uint32_t r : plan_.last_routes()) route(r);
  return out_.take();
}

// Writes the interface of an EXTERNPROTO that was not found, as far as it is known; its URLs are not kept.
void Writer::declare(const NodeType& type, std::string_view name) {
  out_.begin_line("EXTERNPROTO ");
  out_.add(name);
  out_.open(" [");
  for (const FieldSpec& spec : type.fields) {
    out_.begin_line(peerd::vrml::name_of(spec.access));
    for (const std::string_view word : {peerd::vrml::name_of(spec.type), spec.name}) {
      out_.add(" ");
      out_.add(word);
    }
    out_.end_line();
  }
  out_.close("] [ ]");
}

// Writes one node on the line that is begun, and ends the line.
void Writer::item(const NodeRef& ref, std::uint32_t holder) {
  switch (plan_.action_at(ref, holder, visited_)) {
    case RefAction::kDefine:
      return node(ref.index);
    case RefAction::kUse:
      out_.add("USE ");
      out_.add(plan_.name_of(ref.index));
      return out_.end_line();
    case RefAction::kNull:
    case RefAction::kPlaceholder:
    case RefAction::kLater:
      out_.add(kPlaceholderType);
      out_.add(" { }");
      return out_.end_line();
  }
}

void Writer::node(std::uint32_t index) {
  const Node& node = document_.nodes[index];
  if (const std::string_view name = plan_.name_of(index); !name.empty()) {
    out_.add("DEF ");
    out_.add(name);
    out_.add(" ");
  }
  out_.add(plan_.type_name_of(node));
  const std::vector<WrittenField> fields = plan_.fields_of(node);
  if (fields.empty()) {
    out_.add(" { }");
    return out_.end_line();
  }
  out_.open(" {");
  bool has_place = false;
  for (const WrittenField& one : fields) {
    has_place |= holds_nodes(one.spec->type) && one.value != nullptr;
    field(one, index);
  }
  if (has_place) place();
  out_.close("}");
}

void Writer::field(const WrittenField& field, std::uint32_t holder) {
  const FieldSpec& spec = *field.spec;
  const Node& node = document_.nodes[holder];
  const bool has_paths = node.type->role == NodeRole::kCollisionInterest || node.type->role == NodeRole::kKeySensor;
  const bool text = spec.type == FieldType::kSFString || spec.type == FieldType::kMFString;
  if (has_paths && text) return paths(node, *field.value);
  out_.begin_line({});
  if (field.declared) {
    out_.add(peerd::vrml::name_of(spec.access));
    out_.add(" ");
    out_.add(peerd::vrml::name_of(spec.type));
    out_.add(" ");
  }
  out_.add(field.name);
  if (!has_value(spec.access) && spec.access != Access::kContent) return out_.end_line();
  out_.add(" ");
  if (holds_nodes(spec.type)) return nodes(field.value, spec, holder);
  assert(field.value != nullptr && "only nodes can be lost");
  out_.value(*field.value);
}

void Writer::nodes(const Field* value, const FieldSpec& spec, std::uint32_t holder) {
  const std::span<const NodeRef> refs = value == nullptr ? std::span<const NodeRef>{} : value->as<NodeRef>();
  if (spec.type == FieldType::kSFNode) {
    const bool later = !refs.empty() && refs[0].is_node() && refs[0].index >= holder && !visited_[refs[0].index];
    if (!refs.empty() && refs[0].is_node() && !later) return item(refs[0], holder);
    out_.add("NULL");
    return out_.end_line();
  }
  if (refs.empty()) {
    out_.add("[ ]");
    return out_.end_line();
  }
  out_.open("[");
  for (const NodeRef& ref : refs) {
    out_.begin_line({});
    item(ref, holder);
  }
  out_.close("]");
}

// Writes the names of a CollisionInterest or a KeySensor, as they are where all names are those of the world.
void Writer::paths(const Node& node, const Field& value) {
  std::vector<std::string> texts;
  for (const std::string_view path : value.as<std::string_view>()) {
    if (auto text = plan_.path_for(node, path)) texts.push_back(std::move(*text));
  }
  if (value.spec->type == FieldType::kSFString && texts.empty()) return;  // a KeySensor that moves nothing
  out_.begin_line(value.spec->name);
  out_.add(" ");
  if (value.spec->type == FieldType::kMFString) return out_.strings(texts);
  out_.add(string_text(texts[0]));
  out_.end_line();
}

void Writer::route(std::uint32_t index) {
  const Route& route = document_.routes[index];
  out_.begin_line("ROUTE ");
  out_.add(plan_.name_of(route.from_node));
  out_.add(".");
  out_.add(route.from->name);
  out_.add(" TO ");
  out_.add(plan_.name_of(route.to_node));
  out_.add(".");
  out_.add(route.to->name);
  out_.end_line();
}

}  // namespace
}  // namespace vrml

std::expected<WrittenWorld, std::string> write_world(const Scene& scene, const WriteOptions& options) {
  const vrml::WritePlan plan(scene, options);
  if (plan.too_deep()) {
    return std::unexpected("its nodes are nested more than " + std::to_string(vrml::kMaxNesting) +
                           " deep once PROTOs are expanded; no reader of ours would take it");
  }
  return WrittenWorld{vrml::Writer(*scene.document, plan).write(), plan.notes()};
}

}  // namespace peerd
