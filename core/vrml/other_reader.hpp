#pragma once
#include <functional>
#include <memory>

#include "core/vrml/document.hpp"
#include "core/vrml/parse_options.hpp"

namespace peerd::vrml {

// An OtherReader reads a file that an Inline names, where it is of another format than VRML97: it takes the file among
// the sources, reports what is wrong with it, and returns its nodes as a document of their own. Where the file may be
// VRML97 it returns null and leaves the file as it is.
using OtherReader = std::function<std::shared_ptr<const Document>(Source& file, Problems&, const ParseOptions&)>;

}  // namespace peerd::vrml
