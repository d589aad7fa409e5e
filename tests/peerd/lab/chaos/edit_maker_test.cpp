#include "peerd/lab/chaos/edit_maker.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/mixed_bits.hpp"
#include "peerd/lab/chaos/world_text.hpp"
#include "peerd/peer/node/edit_operation.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "replication/objects/replica/owners.hpp"

namespace peerd::chaos::edit_maker_test {

class ChaosEdits : public testing::Test {
 protected:
  static std::vector<config::SceneEdit> edits(EditKind kind, std::uint64_t seed, const Scene& scene) {
    const replication::Owners owners;
    return make_edits({static_cast<std::uint32_t>(seed), 0.0, 0, kind, seed}, {scene, owners, PeerId{1}});
  }
  std::unique_ptr<const SharedWorld> shared = share(draw_world(1, 5));
  const Scene& scene = shared->world.scene;
};

TEST_F(ChaosEdits, AreOfAllKindsAndNameWhatIsThere) {
  std::set<config::SceneEdit::Kind> kinds;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    for (const config::SceneEdit& edit : edits(EditKind::kAny, seed, scene)) {
      kinds.insert(edit.kind);
      if (edit.path == "" || edit.field == "diffuseColor") continue;  // groups have no material
      if (is_about_ownership(edit)) {
        EXPECT_TRUE(scene.find(edit.path)) << edit.path;
        continue;
      }
      const auto operation = operation_of(edit, scene, PeerId{1});
      EXPECT_TRUE(operation) << "seed " << seed << ": " << operation.error();
    }
  }
  EXPECT_EQ(kinds.size(), 13u);
}

TEST_F(ChaosEdits, AreAFunctionOfTheirSeedAndTheScene) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto a = edits(EditKind::kAny, seed, scene), b = edits(EditKind::kAny, seed, scene);
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(name_of(a[0]), name_of(b[0]));
    EXPECT_EQ(a[0].text, b[0].text);
  }
}

TEST_F(ChaosEdits, AreTheSameWithEveryCompiler) {
  std::uint64_t hash = 0;
  const auto add = [&](const std::string& text) {
    for (const char c : text) hash = mixed_bits(hash ^ static_cast<unsigned char>(c)) + 1;
  };
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    for (const EditKind kind :
         {EditKind::kAny, EditKind::kLarge, EditKind::kOneField, EditKind::kOneOwner, EditKind::kOneDatum}) {
      const auto edit = edits(kind, seed, scene).at(0);
      for (const std::string& text : {name_of(edit), edit.text, edit.value, edit.data}) add(text);
    }
  }
  EXPECT_EQ(hash, 557772308551218169u);
}

TEST_F(ChaosEdits, RareOnesAreWhatTheyAreFor) {
  EXPECT_GT(edits(EditKind::kLarge, 1, scene).at(0).text.size(), 60'000u);
  EXPECT_EQ(edits(EditKind::kBurst, 1, scene).size(), 300u);
  for (const EditKind kind : {EditKind::kOneField, EditKind::kOneOwner, EditKind::kOneDatum}) {
    EXPECT_EQ(edits(kind, 1, scene).at(0).path, edits(kind, 2, scene).at(0).path);
  }
}

}  // namespace peerd::chaos::edit_maker_test
