#pragma once
#include <span>
#include <string_view>

namespace peerd::gateway {

// A file of the viewer, as it is embedded in the program.
struct ViewerAsset {
  std::string_view name;  // in the viewer's folder: "index.html", "assets/NAME"
  std::string_view content_type;
  std::string_view hash;     // of its content, in hexadecimal digits
  std::string_view gzipped;  // its content by gzip (RFC 1952)
};

// The files of the viewer. Empty: the program was built without it.
using ViewerAssets = std::span<const ViewerAsset>;

// The viewer that this program was built with.
[[nodiscard]] ViewerAssets built_viewer();

}  // namespace peerd::gateway
