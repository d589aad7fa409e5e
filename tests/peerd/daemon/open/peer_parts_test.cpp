#include "peerd/daemon/open/peer_parts.hpp"

#include <gmock/gmock.h>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::peer_parts_test {

using testing::HasSubstr;

class Parts : public testing::Test {
 protected:
  Parts() {
    folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { children Shape { geometry Box { } } }\n");
    folder.write("s.toml", "world = \"w.wrl\"\n[peer.a]\nid = 1\nowns = [\"CAR\"]\n[peer.b]\nid = 2\n");
    options.config = folder / "s.toml";
  }
  [[nodiscard]] std::string why_not() const {
    const auto parts = make_parts(options, [](const std::string&) {});
    return parts ? "" : parts.error().text;
  }
  testing_support::ScratchFolder folder;
  PeerOptions options;
};

TEST_F(Parts, AreOfThePeerThatIsNamed) {
  options.peer = "a";
  const auto a = must(make_parts(options, [](const std::string& warning) { ADD_FAILURE() << warning; }));
  EXPECT_EQ(a.settings->id, 1u);
  EXPECT_EQ(a.settings, &a.run().peers[0]);
  EXPECT_EQ(a.world_name(options), "w");
  EXPECT_NE(a.session, 0u);
  options.peer = "b";
  const auto b = must(make_parts(options, [](const std::string&) {}));
  EXPECT_EQ(b.settings->id, 2u);
  EXPECT_EQ(b.session, a.session) << "they are in one session";
}

TEST_F(Parts, SayWhichPeersThereAre) {
  EXPECT_THAT(why_not(), HasSubstr("there are a, b"));
  options.peer = "c";
  EXPECT_THAT(why_not(), HasSubstr("no peer \"c\""));
}

TEST_F(Parts, TellAPersonWhatAWorldOrAFileAsksInVain) {
  folder.write("odd.toml", "world = \"w.wrl\"\n[peer.a]\nid = 1\n[replication.classes.ghosts]\nthreshold = 1\n");
  options.config = folder / "odd.toml";
  EXPECT_THAT(why_not(), HasSubstr("odd.toml"));
  options.config = folder / "none.toml";
  EXPECT_THAT(why_not(), HasSubstr("none.toml"));
}

}  // namespace peerd::peer_parts_test
