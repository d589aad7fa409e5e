#include "core/vrml/reader.hpp"

#include <utility>

#include "core/vrml/parser.hpp"
#include "core/vrml/scene_builder.hpp"

namespace peerd {

ReadResult read_world(std::string_view text, const ReadOptions& options) {
  ReadResult result;
  vrml::Problems problems;
  const std::shared_ptr<const vrml::Document> document =
      vrml::parse({options.name, text, nullptr}, problems, {options.load, options.inlines_later, options.limits});
  Scene scene = vrml::build_scene(document, options.tessellation, options.limits, problems);
  if (problems.errors() == 0) result.scene = std::move(scene);
  auto report = problems.take();
  result.diagnostics = std::move(report.diagnostics);
  result.sources = std::move(report.sources);
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
