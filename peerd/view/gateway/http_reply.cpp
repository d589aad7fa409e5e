#include "peerd/view/gateway/http_reply.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/vrml/gzip.hpp"
#include "peerd/peer/control/answer.hpp"

namespace peerd::gateway {
namespace {

constexpr std::size_t kAssetMax_bytes = 64 << 20;  // unpacked; the page's files are some hundred kB
constexpr std::string_view kHtml = "text/html; charset=utf-8";
constexpr std::string_view kWithoutViewer = R"(<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>peerd</title></head>
<body>
<h1>This peer has no viewer</h1>
<p>The program was built without Node, so the viewer's files are not in it. All else is here:
<a href="/api/v1/status">status</a>, <a href="/api/v1/peers">peers</a>, <a href="/api/v1/objects">objects</a>,
<a href="/api/v1/scene.glb">scene.glb</a>, <a href="/metrics">metrics</a>.</p>
</body>
</html>
)";

}  // namespace

HttpReply HttpReply::of(std::string text, std::string_view content_type) {
  HttpReply reply;
  reply.owner = std::make_shared<const std::string>(std::move(text));
  reply.body = *reply.owner;
  reply.content_type = content_type;
  return reply;
}

HttpReply refusal_reply(RefusalKind kind) {
  const RefusalText& text = text_of(kind);
  HttpReply reply = HttpReply::of(control::refusal(std::string(text.sentence)) + '\n');
  reply.status = text.status;
  return reply;
}

HttpReply asset_reply(ViewerAssets assets, const std::string& name, std::string_view known, bool takes_gzip) {
  if (assets.empty() && name == "index.html") {
    HttpReply reply;
    reply.content_type = kHtml;
    reply.body = kWithoutViewer;
    return reply;
  }
  const auto asset = std::ranges::find(assets, name, &ViewerAsset::name);
  if (asset == assets.end()) return refusal_reply(RefusalKind::kNotFound);
  HttpReply reply;
  reply.content_type = asset->content_type;
  reply.etag = '"' + std::string(asset->hash) + '"';
  reply.immutable = name.starts_with("assets/");
  if (known == reply.etag) {
    reply.status = 304;
  } else if (takes_gzip) {
    reply.gzipped = true;
    reply.body = asset->gzipped;
  } else {
    auto unpacked = gunzip(asset->gzipped, kAssetMax_bytes);
    assert(unpacked);  // the build has packed it
    reply.owner = std::make_shared<const std::string>(*std::move(unpacked));
    reply.body = *reply.owner;
  }
  return reply;
}

}  // namespace peerd::gateway
