#include "core/parser/parser.hpp"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "core/parser/text_parser.hpp"
#include "core/vrml/lexer.hpp"
#include "core/x3d/polygon_sets.hpp"

namespace peerd::vrml {
namespace {

// Returns about how many nodes a text has, so that their memory is neither moved nor left empty: its braces, but no
// more than fit in it by far. Braces are few in most of the bytes of a large world, so that looking for them costs next
// to nothing.
std::size_t guess_nodes(std::string_view text, const ReadLimits& limits) {
  constexpr std::size_t kFewestBytes = 16, kSamples = 16, kSampleBytes = 1 << 14;
  const std::size_t stride = std::max(kSampleBytes, text.size() / kSamples);
  std::size_t count = 0, sampled = 0;
  for (std::size_t at = 0; at < text.size(); at += stride) {
    const std::string_view sample = text.substr(at, kSampleBytes);
    count += static_cast<std::size_t>(std::ranges::count(sample, '{'));
    sampled += sample.size();
  }
  if (sampled == 0) return 0;
  const double whole = static_cast<double>(count) * static_cast<double>(text.size()) / static_cast<double>(sampled);
  return std::min({static_cast<std::size_t>(whole), text.size() / kFewestBytes, std::size_t{limits.nodes}});
}

// Returns whether the text behind a header begins with a node or a PROTO, be it an unknown one. A text without a header
// is asked the same.
bool begins_with_a_node(std::string_view text) {
  const auto header = read_header(text);
  return !header && header.error().is_fault;
}

// Repeated ROUTEs are ignored (4.10.2); those of an interface may coincide.
void drop_repeated(std::vector<Route>& routes) {
  std::set<std::tuple<std::uint32_t, const FieldSpec*, std::uint32_t, const FieldSpec*>> seen;
  std::erase_if(routes, [&](const Route& r) { return !seen.emplace(r.from_node, r.from, r.to_node, r.to).second; });
}

}  // namespace

std::shared_ptr<Document> parse(Source world, Problems& problems, const ParseOptions& options, OtherReader read_other) {
  auto document = std::make_shared<Document>();
  ParseContext context{.document = *document,
                       .problems = problems,
                       .options = options,
                       .parse_text = {},
                       .read_other = std::move(read_other)};
  context.parse_text = [&context](const OpenText& text, std::uint32_t nesting, Body& body) {
    return TextParser(context, text, nesting).parse_text(body);
  };
  const std::string name = world.name;
  if (const auto text = open_text(context, std::move(world))) {
    context.open_files.push_back(name);
    const std::string_view read = text->classic ? text->classic->text : problems.text_of(text->begin);
    context.world.nodes.reserve(guess_nodes(read, options.limits));
    static_cast<void>(context.parse_text(*text, 0, context.world));
    document->nodes = std::move(context.world.nodes);
    document->top_level = std::move(context.world.roots);
    document->routes = std::move(context.world.routes);
    document->inner_names = std::move(context.world.inner_names);
    drop_repeated(document->routes);
    const auto is_node = [](const NodeRef& ref) { return ref.is_node(); };
    if (context.has_x3d) keep_polygon_sets(*document, problems, options.limits);
    if (problems.lenient() && problems.faults() > 0 && std::ranges::none_of(document->top_level, is_node) &&
        !begins_with_a_node(problems.text_of(text->begin).substr(text->body))) {
      problems.error(text->begin, "no node of this text can be understood");
    }
  } else if (text.error().is_fault) {
    problems.fault(0, text.error().why, "the text is read as VRML97");
  } else {
    problems.error(0, text.error().why);
  }
  return document;
}

}  // namespace peerd::vrml
