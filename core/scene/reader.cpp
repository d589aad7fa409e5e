#include "core/scene/reader.hpp"

#include <algorithm>
#include <cstdint>
#include <expected>
#include <set>
#include <utility>
#include <vector>

#include "core/animation/file_times.hpp"
#include "core/animation/network_reader.hpp"
#include "core/formats/document_reader.hpp"
#include "core/parser/parser.hpp"
#include "core/scene/mended_geometry.hpp"
#include "core/scene/scene_builder.hpp"

namespace peerd {

namespace {

// Returns the places of the Inlines that were left empty within something that collides.
std::set<std::pair<std::string, std::size_t>> needed_inlines(const Scene& scene, const vrml::Problems& problems) {
  // The pending Inlines of an object are a range, as they stand in the order of their instances: `begins` counts how
  // many ranges begin at each of them, less those that end before it.
  std::vector<std::int64_t> begins(scene.pending_inlines.size() + 1, 0);
  const auto from = [&](std::uint32_t first) -> std::int64_t& {
    const auto index = [&](const PendingInline& p) { return scene.index_of(p.instance); };
    const auto it = std::ranges::lower_bound(scene.pending_inlines, first, {}, index);
    return begins[static_cast<std::size_t>(it - scene.pending_inlines.begin())];
  };
  const auto need = [&](ObjectId object) {
    if (!scene.contains(object)) return;  // it is around
    ++from(scene.index_of(object));
    --from(scene.at(object).subtree_end);
  };
  for (const CollisionInterest& interest : scene.interests) {
    for (const InterestSide* const side : {&interest.colliders, &interest.collidees}) {
      for (const ObjectId end : side->ends) need(end);
      for (const NamePattern& pattern : side->patterns) {
        if (pattern.below) need(*pattern.below);  // more may be found in it
      }
    }
  }
  std::set<std::pair<std::string, std::size_t>> needed;
  std::int64_t ranges = 0;
  for (std::size_t i = 0; i < scene.pending_inlines.size(); ++i) {
    ranges += begins[i];
    if (ranges == 0) continue;
    needed.insert(problems.place_of(scene.document->nodes[scene.at(scene.pending_inlines[i].instance).node].at));
  }
  return needed;
}

}  // namespace

ReadResult read_world(std::string_view text, const ReadOptions& options) {
  ReadResult result;
  vrml::ParseOptions parsing{options.load, options.defer_inlines, {}, options.limits, options.conversion};
  vrml::Problems problems(options.lenient);
  Scene scene;
  // The Inlines that collide are known when all are numbered. They are read in a second pass, and their content may
  // need others. A pass reads at least one more Inline than the pass before it.
  while (true) {
    const std::shared_ptr<vrml::Document> document =
        options.only_vrml ? vrml::parse({options.name, text, nullptr}, problems, parsing)
                          : formats::read_document({options.name, text, nullptr}, problems, parsing);
    if (options.lenient) vrml::mend_geometry(*document, problems);
    if (!options.world_times) vrml::count_from_1970(*document, problems);
    if (options.amend) options.amend(*document, problems);
    scene = vrml::build_scene(document, options.tessellation, options.limits, problems, options.around);
    const std::size_t before = parsing.undeferred_inlines.size();
    parsing.undeferred_inlines.merge(needed_inlines(scene, problems));
    if (parsing.undeferred_inlines.size() == before) break;
    problems = vrml::Problems(options.lenient);
  }
  if (problems.errors() == 0) vrml::check_network(scene.document, problems);
  if (problems.errors() == 0) result.scene = std::move(scene);
  result.faults = problems.faults();
  auto report = problems.take();
  result.diagnostics = std::move(report.diagnostics);
  result.sources = std::move(report.sources);
  return result;
}

ReadResult read_inline(const PendingInline& pending, const ReadOptions& options) {
  std::string tried;
  for (const std::string& url : pending.urls) {
    std::expected<LoadedFile, std::string> file = std::unexpected("no other file is read here");
    if (options.load) file = options.load(std::string_view(url).substr(0, url.find('#')), pending.base);
    if (!file) {
      tried += (tried.empty() ? "" : "; ") + vrml::quoted(url) + ": " + file.error();
      continue;
    }
    ReadOptions inner = options;
    inner.name = file->name;
    const auto bytes = std::make_shared<const std::string>(std::move(file->bytes));
    ReadResult result = read_world(*bytes, inner);
    for (Source& source : result.sources) {
      if (source.owned == nullptr) source.owned = bytes;
    }
    return result;
  }
  ReadResult result;
  result.sources.push_back({pending.base, {}, nullptr});
  result.diagnostics.push_back({Severity::kError, {1, 1}, "this Inline cannot be read: " + tried, 0, 0});
  return result;
}

std::string render(const ReadResult& result, const Diagnostic& diagnostic) {
  const Source& source = result.sources.at(diagnostic.source);
  return render(diagnostic, source.name, source.text);
}

std::uint64_t content_hash(const ReadResult& result) {
  std::uint64_t hash = 14695981039346656037u;
  for (const Source& source : result.sources) {
    for (const char byte : source.text) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  }
  return hash;
}

}  // namespace peerd
