#pragma once
#include <memory>
#include <optional>

#include "core/geometry/geometry.hpp"
#include "core/vrml/document.hpp"

namespace peerd::vrml {

// Returns the fields of a geometry node as a Geometry that shares the arrays of the document. Reports fields that do
// not fit together: indices out of range, a wrong number of heights, polygons without an area; returns nothing where
// that is an error. An ElevationGrid without heights has no polygons where a ROUTE brings them (`takes_heights`).
[[nodiscard]] std::optional<Geometry> read_geometry(const std::shared_ptr<const Document>& document, const Node& node,
                                                    bool takes_heights, Problems& problems);

}  // namespace peerd::vrml
