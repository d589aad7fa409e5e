#pragma once
#include <memory>
#include <string>
#include <string_view>

#include "peerd/view/gateway/refusal_kind.hpp"
#include "peerd/view/gateway/route.hpp"
#include "peerd/view/gateway/viewer_assets.hpp"

namespace peerd::gateway {

struct HttpReply {
  unsigned status = 200;
  std::string_view content_type = "application/json";
  // The body. `owner` keeps it, or it is of the program itself.
  std::string_view body;
  std::shared_ptr<const std::string> owner{};
  std::string etag{};
  bool immutable = false;  // a browser may keep it for ever
  bool gzipped = false;

  [[nodiscard]] static HttpReply of(std::string text, std::string_view content_type = "application/json");
};

// A sentence as JSON, as the control protocol refuses.
[[nodiscard]] HttpReply refusal_reply(RefusalKind kind);

// A file of the viewer. `known`: the header If-None-Match. `takes_gzip`: the client unpacks it.
[[nodiscard]] HttpReply asset_reply(ViewerAssets assets, const std::string& name, std::string_view known,
                                    bool takes_gzip);

}  // namespace peerd::gateway
