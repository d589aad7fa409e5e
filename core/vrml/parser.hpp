#pragma once
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "core/vrml/document.hpp"
#include "core/vrml/file_loader.hpp"

namespace peerd::vrml {

struct ParseOptions {
  FileLoader load;             // without it, no Inline and no EXTERNPROTO is found
  bool defer_inlines = false;  // an Inline that says how large it is (bboxSize) is left empty
  // but for those that stand there: a source's name, and an offset in its text
  std::set<std::pair<std::string, std::size_t>> undeferred_inlines{};
  ReadLimits limits;
};

// A world's text, packed or not, and the files that it names, to nodes. Reports all problems that it can find in one
// pass and leaves out what it cannot read; the document stands for the world only where there is no error.
[[nodiscard]] std::shared_ptr<Document> parse(Source world, Problems& problems, const ParseOptions& options = {});

}  // namespace peerd::vrml
