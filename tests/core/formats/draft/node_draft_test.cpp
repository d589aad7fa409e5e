#include "core/formats/draft/node_draft.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::formats::node_draft_test {
namespace {

using testing::ElementsAre;

TEST(NodeDraft, HasTheFieldsThatItIsGiven) {
  vrml::Document document;
  const vrml::NodeRef box = NodeDraft(document, "Box", 3).floats("size", {1, 2, 3}).add();
  const vrml::NodeRef shape =
      NodeDraft(document, "Shape", 4).named("S").node("geometry", box).node("appearance", {}).add();
  document.top_level.push_back(shape);
  EXPECT_EQ(vrml::document_violation(document), "");
  EXPECT_EQ(document.nodes[shape.index].def, "S");
  EXPECT_EQ(document.nodes[shape.index].field_count, 1U);
  EXPECT_THAT(vrml::floats(document.nodes[box.index], "size"), ElementsAre(1, 2, 3));
}

TEST(NodeDraft, GivesItsFieldsToANodeThatIsThere) {
  vrml::Document document;
  const vrml::NodeRef made =
      NodeDraft(document, "Transform", 0).floats("translation", {1, 2, 3}).floats("scale", {2, 2, 2}).add();
  NodeDraft(document, "Transform", 0)
      .floats("scale", {3, 3, 3})
      .flag("enslaved", true)
      .give_to(document.nodes[made.index]);
  EXPECT_THAT(vrml::floats(document.nodes[made.index], "translation"), ElementsAre(1, 2, 3));
  EXPECT_THAT(vrml::floats(document.nodes[made.index], "scale"), ElementsAre(3, 3, 3));
  EXPECT_EQ(document.nodes[made.index].field_count, 3U);
}

}  // namespace
}  // namespace peerd::formats::node_draft_test
