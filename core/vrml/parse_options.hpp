#pragma once
#include <cstddef>
#include <set>
#include <string>
#include <utility>

#include "core/vrml/file_loader.hpp"

namespace peerd {

// A Conversion leads from the lengths and axes of a file to those of a world: metres, +Y up.
struct Conversion {
  double metres_per_unit = 1.0;  // > 0
  bool z_up = false;             // +Z of the file points up, and -Y to the viewer; otherwise +Y points up

  friend bool operator==(const Conversion&, const Conversion&) = default;
};

namespace vrml {

struct ParseOptions {
  FileLoader load;             // without it, no Inline and no EXTERNPROTO is found
  bool defer_inlines = false;  // an Inline that says how large it is (bboxSize) is left empty
  // Deferred Inlines that are read nevertheless, by their place: the name of a source, and an offset in its text.
  std::set<std::pair<std::string, std::size_t>> undeferred_inlines{};
  ReadLimits limits;
  Conversion conversion{};  // of files that are no VRML97
};

}  // namespace vrml
}  // namespace peerd
