#include "peerd/view/gateway/viewer_assets.hpp"

namespace peerd::gateway {

ViewerAssets built_viewer() { return {}; }

}  // namespace peerd::gateway
