#include "peerd/view/gateway/http_reply.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "tests/core/gzip_text.hpp"

namespace peerd::gateway::http_reply_test {

using testing::HasSubstr;

struct Viewer {
  std::string page = "<p>page</p>", script = std::string(200'000, 'x') + "end";
  std::string packed_page = gzipped(page), packed_script = gzipped(script);
  std::array<ViewerAsset, 2> assets{
      {{"index.html", "text/html", "a1", packed_page}, {"assets/app-1.js", "text/javascript", "b2", packed_script}}};
};

TEST(AssetReply, IsPackedForWhoUnpacksIt) {
  const Viewer viewer;
  const HttpReply packed = asset_reply(viewer.assets, "assets/app-1.js", "", true);
  EXPECT_EQ(packed.status, 200U);
  EXPECT_TRUE(packed.gzipped);
  EXPECT_TRUE(packed.immutable);
  EXPECT_EQ(packed.body, viewer.packed_script);
  EXPECT_EQ(packed.etag, "\"b2\"");
  const HttpReply plain = asset_reply(viewer.assets, "assets/app-1.js", "", false);
  EXPECT_FALSE(plain.gzipped);
  EXPECT_EQ(plain.body, viewer.script);
  EXPECT_FALSE(asset_reply(viewer.assets, "index.html", "", true).immutable) << "it names the others";
}

TEST(AssetReply, IsNotSentAgain) {
  const Viewer viewer;
  EXPECT_EQ(asset_reply(viewer.assets, "index.html", "\"a1\"", true).status, 304U);
  EXPECT_EQ(asset_reply(viewer.assets, "index.html", "\"a0\"", true).status, 200U);
}

TEST(AssetReply, NamesAreThoseOfTheTableAlone) {
  const Viewer viewer;
  for (const char* other : {"", "assets", "assets/", "assets/app-1.js/", "assets/../index.html", "/index.html",
                            "INDEX.HTML", "assets/../../etc/passwd", "assets/%2e%2e/index.html"}) {
    EXPECT_EQ(asset_reply(viewer.assets, other, "", true).status, 404U) << other;
  }
}

TEST(AssetReply, WithoutAViewerThePageSaysSo) {
  const HttpReply page = asset_reply({}, "index.html", "", true);
  EXPECT_EQ(page.status, 200U);
  EXPECT_THAT(std::string(page.body), HasSubstr("has no viewer"));
  EXPECT_EQ(asset_reply({}, "assets/app-1.js", "", true).status, 404U);
}

}  // namespace peerd::gateway::http_reply_test
