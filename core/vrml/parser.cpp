#include "core/vrml/parser.hpp"

#include <algorithm>
#include <expected>
#include <set>
#include <tuple>
#include <utility>

#include "core/vrml/gzip.hpp"
#include "core/vrml/text_parser.hpp"

namespace peerd::vrml {
namespace {

// About how many nodes a text has, so that their memory is neither moved nor left empty: its braces, but no more than
// fit in it by far. Few in most of a large world's bytes, so that looking for them costs next to nothing.
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

// 4.10.2: repeated ROUTEs are ignored; those of an interface may coincide.
void drop_repeated(std::vector<Route>& routes) {
  std::set<std::tuple<std::uint32_t, const FieldSpec*, std::uint32_t, const FieldSpec*>> seen;
  std::erase_if(routes, [&](const Route& r) { return !seen.emplace(r.from_node, r.from, r.to_node, r.to).second; });
}

}  // namespace

std::expected<OpenText, std::string> open_text(ParseContext& context, Source source) {
  const std::uint64_t left =
      context.options.limits.text_bytes - std::min(context.text_bytes, context.options.limits.text_bytes);
  std::expected<Header, std::string> header = std::unexpected("");
  if (is_gzip(source.text)) {
    std::expected<std::string, std::string> unpacked = gunzip(source.text, left);
    if (unpacked) {
      source.owned = std::make_shared<const std::string>(std::move(*unpacked));
      source.text = *source.owned;
      header = read_header(source.text);
    } else {
      header = std::unexpected(unpacked.error());
    }
  } else if (source.text.size() > left) {
    header = std::unexpected("it is larger than " + std::to_string(left) + " bytes, more than this reader takes");
    source.text = {};
  } else {
    header = read_header(source.text);
  }
  context.text_bytes += source.text.size();
  const std::optional<Position> begin = context.problems.open(std::move(source));
  if (!header) return std::unexpected(header.error());
  if (!begin) return std::unexpected("its files together are larger than 4 GiB, more than this reader takes");
  if (!header->remark.empty()) context.problems.warning(*begin, std::string(header->remark));
  return OpenText{*begin, header->end};
}

std::shared_ptr<Document> parse(Source world, Problems& problems, const ParseOptions& options) {
  auto document = std::make_shared<Document>();
  ParseContext context{.document = *document, .problems = problems, .options = options};
  const std::string name = world.name;
  if (const auto text = open_text(context, std::move(world))) {
    context.open_files.push_back(name);
    context.world.nodes.reserve(guess_nodes(problems.text_of(text->begin), options.limits));
    TextParser(context, text->begin, text->body, 0).parse_text(context.world);
    document->nodes = std::move(context.world.nodes);
    document->top_level = std::move(context.world.roots);
    document->routes = std::move(context.world.routes);
    document->inner_names = std::move(context.world.inner_names);
    drop_repeated(document->routes);
  } else {
    problems.error(0, text.error());
  }
  return document;
}

}  // namespace peerd::vrml
