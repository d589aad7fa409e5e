#include "core/writer/write_plan.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::vrml::write_plan_test {

// A name means the last node before it that has it (4.4.3), so two nodes may have one name where their uses do not
// meet.
TEST(WritePlan, ChangesANameOnlyWhereAnotherNodeTakesItTooEarly) {
  const Scene apart = scene_of("DEF A Group { } USE A DEF A Transform { } USE A");
  const WritePlan kept(apart, {});
  EXPECT_EQ(kept.name_of(apart.document->top_level[0].index), "A");
  EXPECT_EQ(kept.name_of(apart.document->top_level[2].index), "A");
  // The instances of P keep their inner names, and here the first is used when the second has been defined.
  const Scene mixed = scene_of(
      "PROTO P [ field MFNode a [ ] ] { Group { children [ Group { children IS a } Group { children IS a } ] } }\n"
      "PROTO Q [ ] { DEF N Group { } }\n"
      "P { a [ Q { } Q { } ] }");
  const WritePlan changed(mixed, {});
  std::vector<std::string_view> names;
  for (std::uint32_t i = 0; i < mixed.document->nodes.size(); ++i) {
    if (mixed.document->nodes[i].def == "N") names.push_back(changed.name_of(i));
  }
  ASSERT_EQ(names.size(), 2u);
  EXPECT_NE(names[0], names[1]);
}

TEST(OutsideNodes, AreThoseThatMatterAndThatNothingHolds) {
  const Scene scene = scene_of("PROTO P [ ] { Group { } DEF T TimeSensor { } Material { } } P { }");
  const PathRewriter paths(scene);
  const OutsideNodes outside = outside_nodes(*scene.document, paths);
  EXPECT_EQ(outside.plain.size() + outside.held.size(), 1u);
}

}  // namespace peerd::vrml::write_plan_test
