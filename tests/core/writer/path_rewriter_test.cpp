#include "core/writer/path_rewriter.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::path_rewriter_test {

constexpr const char* kWorld =
    "PROTO P [ ] { Group { children [ DEF IN Transform { } DEF B Shape { geometry Box { } }\n"
    "  CollisionInterest { objectPath \"IN\" interests \"B\" } ] } }\n"
    "DEF A Transform { children DEF C Transform { } } P { }";

std::uint32_t scope_of_interest(const Scene& scene) {
  return scene.document->nodes[nodes_of_type(*scene.document, "CollisionInterest").at(0)].scope;
}

TEST(PathRewriter, RewritesPathsToTheNewNames) {
  const Scene scene = scene_of(kWorld);
  PathRewriter paths(scene);
  std::vector<std::string_view> names;
  for (const Node& node : scene.document->nodes) names.push_back(node.def == "IN" ? "IN_2" : node.def);
  paths.rename(names, std::vector<bool>(names.size(), true));
  EXPECT_EQ(paths.rewritten("IN", scope_of_interest(scene)), "1/IN_2");
  EXPECT_EQ(paths.rewritten("A", 0), "A");
  EXPECT_EQ(paths.rewritten("nobody", 0), std::nullopt);
}

}  // namespace peerd::vrml::path_rewriter_test
