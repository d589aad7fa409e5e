#pragma once
#include <memory>
#include <optional>

#include "core/geometry/geometry.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// A geometry node's fields as a Geometry that shares the document's arrays. Reports what does not fit together:
// indices out of range, a wrong number of heights, polygons without an area; none where that is an error.
[[nodiscard]] std::optional<Geometry> read_geometry(const std::shared_ptr<const Document>& document, const Node& node,
                                                    Problems& problems);

}  // namespace peerd::vrml
