#pragma once
#include <cstddef>
#include <set>
#include <string>
#include <utility>

#include "core/vrml/file_loader.hpp"

namespace peerd::vrml {

struct ParseOptions {
  FileLoader load;             // without it, no Inline and no EXTERNPROTO is found
  bool defer_inlines = false;  // an Inline that says how large it is (bboxSize) is left empty
  // but for those that stand there: a source's name, and an offset in its text
  std::set<std::pair<std::string, std::size_t>> undeferred_inlines{};
  ReadLimits limits;
};

}  // namespace peerd::vrml
