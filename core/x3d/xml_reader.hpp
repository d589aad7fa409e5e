#pragma once
#include "core/vrml/diagnostics.hpp"
#include "core/vrml/file_loader.hpp"
#include "core/x3d/classic_text.hpp"

namespace peerd::vrml {

// Reads X3D in XML (ISO/IEC 19776-1) and says the same in the Classic VRML encoding. The text stands at `begin` among
// those of the world. What is wrong with it as XML is an error in `problems`, and the result is empty; what else is
// wrong is left out, or left to the reader of the result.
[[nodiscard]] ClassicText classic_of_xml(Position begin, Problems& problems, const ReadLimits& limits);

}  // namespace peerd::vrml
