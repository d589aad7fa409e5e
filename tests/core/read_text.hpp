#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/vrml/reader.hpp"

namespace peerd {

// The header stands in line 1, so the first line of `body` is line 2.
inline std::string world_text(const std::string& body) { return "#VRML V2.0 utf8\n" + body; }

inline Scene scene_of(const std::string& body) {
  const std::string text = world_text(body);
  ReadResult result = read_world(text);
  for (const Diagnostic& d : result.diagnostics) {
    if (d.severity == Severity::kError) ADD_FAILURE() << render(result, d);
  }
  return result.scene.value_or(Scene{});
}

// LINE:COLUMN: MESSAGE of each error; warnings begin with "warning ".
inline std::vector<std::string> problems_of(const std::string& body) {
  std::vector<std::string> lines;
  for (const Diagnostic& d : read_world(world_text(body)).diagnostics) {
    lines.push_back((d.severity == Severity::kWarning ? "warning " : "") + std::to_string(d.where.line) + ":" +
                    std::to_string(d.where.column) + ": " + d.message);
  }
  return lines;
}

}  // namespace peerd
