#pragma once
#include <memory>

#include "core/vrml/document.hpp"
#include "core/vrml/other_reader.hpp"
#include "core/vrml/parse_options.hpp"

namespace peerd::vrml {

// A world's text, packed or not, and the files that it names, to nodes. Reports all problems that it can find in one
// pass and leaves out what it cannot read; the document stands for the world only where there is no error. `read_other`
// reads files of other formats than VRML97 for Inlines; without it there are none.
[[nodiscard]] std::shared_ptr<Document> parse(Source world, Problems& problems, const ParseOptions& options = {},
                                              OtherReader read_other = {});

}  // namespace peerd::vrml
