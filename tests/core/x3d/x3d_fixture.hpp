#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/writer/scene_difference.hpp"
#include "core/writer/writer.hpp"
#include "tests/core/formats/format_fixture.hpp"

namespace peerd::vrml {

using formats::error_of;
using formats::NamedFiles;
using formats::warnings_of;

inline ReadResult read_classic(const std::string& body, const NamedFiles& files = {}) {
  return formats::read_file("a.x3dv", "#X3D V3.3 utf8\n" + body, files);
}
// The nodes of a Scene; its first line is line 1.
inline ReadResult read_xml(const std::string& scene, const NamedFiles& files = {}) {
  return formats::read_file("a.x3d", "<X3D><Scene>" + scene + "</Scene></X3D>", files);
}
inline ReadResult read_vrml97(const std::string& body, const NamedFiles& files = {}) {
  return formats::read_file("a.wrl", "#VRML V2.0 utf8\n" + body, files);
}

// Says how two worlds differ; nothing where they are one.
inline std::string difference_of(const ReadResult& a, const ReadResult& b) {
  for (const ReadResult* const one : {&a, &b}) {
    for (const Diagnostic& d : one->diagnostics) {
      if (d.severity == Severity::kError) return render(*one, d);
    }
    const std::string violation = document_violation(*one->scene->document);
    if (!violation.empty()) return violation;
  }
  return difference(*a.scene, *b.scene);
}

// Returns the world as VRML97.
inline std::string written(const ReadResult& result) {
  if (!result.scene) return "no world: " + result.diagnostics.at(0).message;
  return write_world(*result.scene).value().text;
}

}  // namespace peerd::vrml
