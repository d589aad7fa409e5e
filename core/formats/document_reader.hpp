#pragma once
#include <memory>

#include "core/vrml/document.hpp"
#include "core/vrml/parse_options.hpp"

namespace peerd::formats {

// Reads a world's file and the files that it names. kind_of() decides the format; the document does not depend on it.
// `problems` gets the errors of the file, and a warning for each part of it that a document cannot keep.
[[nodiscard]] std::shared_ptr<vrml::Document> read_document(Source world, vrml::Problems& problems,
                                                            const vrml::ParseOptions& options);

}  // namespace peerd::formats
