// The real program: peers that are found, and joining peers that have no file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <cstdlib>
#include <filesystem>
#include <iterator>

#include <nlohmann/json.hpp>

#include "peerd/net/keys/key_file.hpp"
#include "tests/core/formats/gltf/gltf_fixture.hpp"
#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"

namespace peerd::join_test {

using net::testing_support::own_port;
using nlohmann::json;
using testing::HasSubstr;
using testing_support::Process;

using Words = std::vector<std::string>;

// The world is called as nobody else's on this computer.
class Joining : public testing_support::ControlledPeers {
 protected:
  Joining() {
    folder.write("wheel.wrl", "#VRML V2.0 utf8\nTransform { translation 0 1 0 children Shape { geometry Box { } } }\n");
    folder.write("w.wrl", "#VRML V2.0 utf8\nDEF CAR Transform { children Inline { url \"wheel.wrl\" } }\n");
  }

  Process start(const std::string& name, Words words, const Words& more = {}) const {
    words.insert(words.end(), {"--interface", "lo", "--store", (folder / (name + ".store")).string()});
    words.insert(words.end(), more.begin(), more.end());
    return ControlledPeers::start(name, words);
  }
  Process run(const std::string& name, const std::string& called, const Words& more = {}) const {
    Words words{"run",          "--world", (folder / "w.wrl").string(), "--port", std::to_string(own_port(13)),
                "--world-name", called};
    words.insert(words.end(), more.begin(), more.end());
    return start(name, words);
  }
  Process join(const std::string& name, const std::string& called, const Words& more = {}) const {
    return start(name, {"join", called}, more);
  }

  const std::string world = "world-" + std::to_string(getpid());
};

TEST_F(Joining, AJoiningPeerNeedsNoFile) {
  Process a = run("a", world), b = run("b", world);
  ASSERT_TRUE(is_in_session("a") && is_in_session("b")) << a.out() << b.out();
  ASSERT_TRUE(add("a", "BALL")) << a.out() << a.err();
  ASSERT_TRUE(wait_until([&] { return world_of("b") == world_of("a"); })) << b.out() << b.err();
  Process c = join("c", world);
  ASSERT_TRUE(is_in_session("c")) << c.err();
  EXPECT_THAT(c.err(), HasSubstr("got \"" + world + "\" from "));
  EXPECT_THAT(c.err(), HasSubstr(" has the same"));
  EXPECT_EQ(world_of("c"), world_of("a"));
  ASSERT_TRUE(add("c", "CONE")) << c.err();
  EXPECT_TRUE(wait_until([&] { return world_of("a") == world_of("c"); })) << a.err() << c.err();
}

// What the viewer of a peer draws: the bytes of its scene.
std::string picture_of(const Process& peer) {
  constexpr std::string_view kBefore = "the viewer is at http://127.0.0.1:";
  const std::string said = peer.out();
  const std::size_t at = said.find(kBefore);
  if (at == std::string::npos) return {};
  const std::string port = said.substr(at + kBefore.size(), said.find('/', at + kBefore.size()) - at - kBefore.size());
  boost::asio::ip::tcp::iostream stream("127.0.0.1", port);
  stream << "GET /api/v1/scene.glb HTTP/1.0\r\nHost: 127.0.0.1:" << port << "\r\n\r\n" << std::flush;
  return {std::istreambuf_iterator<char>(stream), {}};
}

// The file moves the arm, by world time on both peers: it meets the crate and the post every two seconds.
TEST_F(Joining, AJoiningPeerGetsAWorldOfAnotherFormatWithItsFiles) {
  formats::gltf::GltfMaker maker;
  maker.points({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  maker.indices({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
  maker.accessor<float>({0, 0, 1, 0, 0, 1, 1, 1}, "VEC2", 5126, 4);
  maker.accessor<float>({0, 2}, "SCALAR", 5126, 2);
  maker.points({-4, 0, 0, 4, 0, 0});
  const std::string mesh =
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":2},\"indices\":1,\"material\":0}]}],"
      "\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorTexture\":{\"index\":0}}}],"
      "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"a.png\"}],";
  folder.write(
      "w.gltf",
      maker.json(mesh + "\"nodes\":[{\"name\":\"left "
                        "arm\",\"mesh\":0},{\"name\":\"crate\",\"mesh\":0},{\"name\":\"post\",\"mesh\":0,"
                        "\"translation\":[2,0,0]}],"
                        "\"scenes\":[{\"nodes\":[0,1,2]}],\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{"
                        "\"node\":0,\"path\":\"translation\"}}],\"samplers\":[{\"input\":3,\"output\":4}]}]",
                 "b.bin"));
  folder.write("b.bin", maker.buffer());
  const std::string image("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x8\2\0\0\0\x90wS\xde", 33);
  folder.write("a.png", image);
  folder.write("w.gltf.peerd.toml", "collide = \"all\"\n");
  Process a = start("a", {"run", "--world", (folder / "w.gltf").string(), "--port", std::to_string(own_port(13)),
                          "--world-name", world, "--own", "crate", "--view"});
  ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
  for (const char* const file : {"w.gltf", "b.bin", "a.png", "w.gltf.peerd.toml"})
    std::filesystem::remove(folder / file);
  Process b = join("b", world, {"--view"});
  ASSERT_TRUE(is_in_session("b")) << b.out() << b.err();
  EXPECT_EQ(world_of("b"), world_of("a"));
  // Nobody owns the post, so that both find the contact by themselves; the crate's owner decides about the other one.
  EXPECT_TRUE(b.says("\"left arm\" met post", 20)) << b.out();
  EXPECT_TRUE(a.says("\"left arm\" met post", 20)) << a.out();
  EXPECT_TRUE(a.says("\"left arm\" hit crate", 20)) << a.out();
  EXPECT_THAT(picture_of(b), HasSubstr(image));
  EXPECT_THAT(picture_of(a), HasSubstr(image));
}

TEST_F(Joining, LsSaysWhoIsHere) {
  Process a = run("a", world, {"--id", "17"});
  ASSERT_TRUE(a.says("gives \"" + world + "\" to who joins", 10)) << a.out() << a.err();
  Process ls(folder, "ls", PEERD_PROGRAM, {"ls", "--interface", "lo", "--json"});
  ASSERT_EQ(ls.exit_code(10), 0) << ls.err();
  const json all = json::parse(ls.out()).at("worlds");
  const auto found = std::ranges::find_if(all, [&](const json& each) { return each.at("name") == world; });
  ASSERT_NE(found, all.end()) << ls.out();
  ASSERT_EQ(found->at("peers").size(), 1u);
  EXPECT_EQ(found->at("peers")[0].at("id"), 17);
  EXPECT_EQ(found->at("peers")[0].at("name"), "a");
  EXPECT_EQ(found->at("peers")[0].at("address"), "127.0.0.1");
}

// Both are of one file, at one port.
TEST_F(Joining, WorldsOfTwoNamesDoNotMix) {
  Process a = run("a", world + "-1"), b = run("b", world + "-2");
  ASSERT_TRUE(is_in_session("a") && is_in_session("b"));
  ASSERT_TRUE(add("a", "BALL"));
  Process c = join("c", world + "-2");
  ASSERT_TRUE(is_in_session("c")) << c.err();
  EXPECT_EQ(world_of("c").find("BALL"), std::string::npos);
  EXPECT_EQ(ask("c", {{"do", "status"}}).at("members").size(), 1u);
}

TEST_F(Joining, NobodyIsHereAndAStoreIs) {
  std::string before;
  std::uint64_t id = 0;
  {
    Process a = run("a", world);
    ASSERT_TRUE(is_in_session("a") && add("a", "BALL")) << a.out() << a.err();
    before = world_of("a");
    id = ask("a", {{"do", "status"}}).at("peer").at("id").get<std::uint64_t>();
    a.signal(SIGKILL);
    EXPECT_EQ(a.exit_code(5), -1);
  }
  std::filesystem::remove(folder / "w.wrl");
  std::filesystem::remove(folder / "wheel.wrl");
  Process again = join("a", world);
  ASSERT_TRUE(is_in_session("a")) << again.err();
  EXPECT_THAT(again.err(), HasSubstr("no peer of \"" + world + "\" is here: begins with the store "));
  EXPECT_EQ(world_of("a"), before);
  EXPECT_EQ(ask("a", {{"do", "status"}}).at("peer").at("id").get<std::uint64_t>(), id);
  Process b = join("b", world);
  ASSERT_TRUE(is_in_session("b")) << b.err();
  EXPECT_EQ(world_of("b"), before);
}

// Without --store a peer has one among this user's own.
TEST_F(Joining, ThisUsersStoreOfThatPeerIsChosen) {
  setenv("XDG_STATE_HOME", (folder / "state").c_str(), 1);
  const auto start_with_default_store = [&](const std::string& name, Words words) {
    words.insert(words.end(), {"--interface", "lo"});
    return ControlledPeers::start(name, words);
  };
  for (const std::string name : {"a", "b"}) {
    Process peer = start_with_default_store(name, {"run", "--world", (folder / "w.wrl").string(), "--port",
                                                   std::to_string(own_port(13)), "--world-name", world});
    ASSERT_TRUE(is_in_session(name) && add(name, "OF_" + name)) << peer.out() << peer.err();
    peer.signal(SIGTERM);
    ASSERT_EQ(peer.exit_code(5), 0);
  }
  Process nobodys = start_with_default_store("c", {"join", world});
  EXPECT_EQ(nobodys.exit_code(10), 3);
  EXPECT_THAT(nobodys.err(), HasSubstr("there is more than one store"));
  Process again = start_with_default_store("b", {"join", world});
  ASSERT_TRUE(is_in_session("b")) << again.err();
  EXPECT_THAT(world_of("b"), HasSubstr("OF_b"));
  EXPECT_THAT(world_of("b"), testing::Not(HasSubstr("OF_a")));
  unsetenv("XDG_STATE_HOME");
}

TEST_F(Joining, ThereIsNoSuchWorld) {
  Process c = join("c", world);
  EXPECT_EQ(c.exit_code(10), 3);
  EXPECT_THAT(c.err(), testing::StartsWith("error: no peer of \"" + world + "\" answers, and"));
  EXPECT_THAT(c.err(), HasSubstr("it was asked for by group 239.192.79.255 port 47473 over lo"));
}

TEST_F(Joining, OnePeerIsAskedByItsAddress) {
  Process a = run("a", world, {"--set", "transport.snapshot_port=" + std::to_string(own_port(14))});
  ASSERT_TRUE(is_in_session("a"));
  Process c = join("c", world, {"--from", "127.0.0.1:" + std::to_string(own_port(14))});
  ASSERT_TRUE(is_in_session("c")) << c.err();
  EXPECT_EQ(world_of("c"), world_of("a"));
}

// Somebody else, with settings of their own, gets one line.
TEST_F(Joining, AnInvitationIsAllThatSomebodyElseNeeds) {
  Process a = run("a", world);
  ASSERT_TRUE(is_in_session("a"));
  Process invite(folder, "invite", PEERD_PROGRAM, {"invite", world});
  ASSERT_EQ(invite.exit_code(10), 0) << invite.err();
  const std::string begin = "peerd join --invite ";
  ASSERT_TRUE(invite.out().starts_with(begin)) << invite.out();
  const std::string invitation = invite.out().substr(begin.size(), invite.out().size() - begin.size() - 1);

  const auto join_there = [&](const std::string& name, const Words& more) {
    Words words{"join", "--interface", "lo", "--store", ""};
    words.insert(words.end(), more.begin(), more.end());
    return ControlledPeers::start(name, words, "elsewhere");
  };
  Process uninvited = join_there("uninvited", {world});
  EXPECT_EQ(uninvited.exit_code(10), 3);
  EXPECT_THAT(uninvited.err(), HasSubstr("whoever runs that world has its key"));
  Process damaged = join_there("damaged", {"--invite", invitation.substr(0, invitation.size() - 1)});
  EXPECT_EQ(damaged.exit_code(10), 2);
  Process invited = join_there("invited", {"--invite", invitation});
  ASSERT_TRUE(is_in_session("invited")) << invited.err();
  EXPECT_EQ(world_of("invited"), world_of("a"));
  EXPECT_THAT(invited.out() + invited.err(), testing::Not(HasSubstr(invitation))) << "it is in no log";
  EXPECT_THAT(invited.command_line(), testing::AllOf(HasSubstr("--invite"), testing::Not(HasSubstr(invitation))));
  Process again = join_there("again", {world});
  ASSERT_TRUE(is_in_session("again")) << again.err() << "the key was kept";
  ASSERT_TRUE(add("invited", "BALL"));
  EXPECT_TRUE(wait_until([&] { return world_of("a") == world_of("invited") && world_of("a") == world_of("again"); }));
}

// The line comes as it was printed, with the command before it, from a file that no list of processes shows.
TEST_F(Joining, AnInvitationMayComeByStandardInput) {
  Process a = run("a", world);
  ASSERT_TRUE(is_in_session("a"));
  Process invite(folder, "invite", PEERD_PROGRAM, {"invite", world});
  ASSERT_EQ(invite.exit_code(10), 0) << invite.err();
  EXPECT_THAT(invite.err(), HasSubstr("peerd join --invite -"));
  const auto join_by = [&](const std::string& name, const std::string& line) {
    folder.write(name + ".txt", line);
    return Process(
        folder, name, "/bin/sh",
        {"-c", "exec \"$0\" \"$@\" <" + (folder / (name + ".txt")).string(), PEERD_PROGRAM, "join", "--name", name,
         "--interface", "lo", "--store", "", "--control", (folder / (name + ".sock")).string(), "--invite", "-"},
        name);
  };
  Process nothing = join_by("nothing", ""), other = join_by("other", "peerd join --invite\n");
  EXPECT_EQ(nothing.exit_code(10), 2);
  EXPECT_THAT(nothing.err(), HasSubstr("nothing came"));
  EXPECT_EQ(other.exit_code(10), 2);
  EXPECT_THAT(other.err(), HasSubstr("no whole invitation"));
  Process invited = join_by("invited", invite.out());
  ASSERT_TRUE(is_in_session("invited")) << invited.err();
  EXPECT_EQ(world_of("invited"), world_of("a"));
}

// A password, once typed and once in a file, is all that two users share. Another one is none.
TEST_F(Joining, APasswordIsAllThatTwoUsersShare) {
  const auto password = [&](const std::string& name, const std::string& text) {
    folder.write(name, text + "\n");
    std::filesystem::permissions(folder / name, std::filesystem::perms::owner_read);
    return (folder / name).string();
  };
  const std::string right = password("right", "correct horse"), wrong = password("wrong", "correct mule");
  Process a = run("a", world, {"--password-file", right});
  ASSERT_TRUE(is_in_session("a")) << a.err();
  EXPECT_THAT(a.out(), HasSubstr("sealed by a password\n"));
  EXPECT_EQ(ask("a", {{"do", "status"}}).at("session").at("sealed_by"), "a password");
  const auto join_there = [&](const std::string& name, const std::string& file, const std::string& input) {
    return Process(folder, name, "/bin/sh",
                   {"-c", "exec \"$0\" \"$@\" <" + input, PEERD_PROGRAM, "join", world, "--name", name, "--interface",
                    "lo", "--store", "", "--control", (folder / (name + ".sock")).string(), "--password-file", file},
                   "elsewhere");
  };
  Process stranger = join_there("stranger", wrong, "/dev/null");
  EXPECT_EQ(stranger.exit_code(10), 3);
  EXPECT_THAT(stranger.err(), HasSubstr("it has another key; --key FILE says one"));
  Process b = join_there("b", "-", right);
  ASSERT_TRUE(is_in_session("b")) << b.err();
  ASSERT_TRUE(add("b", "BALL"));
  EXPECT_TRUE(wait_until([&] { return world_of("a") == world_of("b"); }));
  EXPECT_THAT(b.out() + b.err(), testing::Not(HasSubstr("correct"))) << "it is in no log";
  EXPECT_FALSE(std::filesystem::exists(folder / "elsewhere/peerd/keys")) << "and no key is kept";
  Process both = start("both", {"join", world, "--password-file", right, "--key", right});
  EXPECT_EQ(both.exit_code(10), 2);
}

// Nobody waits for what cannot be where one peer is asked by its address, either.
TEST_F(Joining, WhoAsksOnePeerIsToldAtOnceHowItIsSealed) {
  Process sealed = run("sealed", world, {"--set", "transport.snapshot_port=" + std::to_string(own_port(14))});
  Process open =
      run("open", world + "-open", {"--open", "--set", "transport.snapshot_port=" + std::to_string(own_port(15))});
  ASSERT_TRUE(is_in_session("sealed") && is_in_session("open"));
  const auto why_not = [&](unsigned slot, const Words& more) {
    Words words{"join", world, "--store", "", "--control", "", "--from", "127.0.0.1:" + std::to_string(own_port(slot))};
    words.insert(words.end(), more.begin(), more.end());
    Process join(folder, "why", PEERD_PROGRAM, words);
    EXPECT_EQ(join.exit_code(10), 3) << "it waits";
    return join.err();
  };
  EXPECT_THAT(why_not(14, {"--open"}), HasSubstr("it is sealed, and begins with a key: leave out --open"));
  EXPECT_THAT(why_not(15, {}), HasSubstr("it is open, and does not have the key"));
  ASSERT_TRUE(keys::read_or_make_key(folder / "other.key"));
  EXPECT_THAT(why_not(14, {"--key", (folder / "other.key").string()}),
              HasSubstr("it has another key; --key FILE says one"));
}

// Both say how they are, so that nobody waits for what cannot be.
TEST_F(Joining, WhoComesOpenToASealedWorldIsTold) {
  Process a = run("a", world), b = run("b", world + "-open", {"--open"});
  ASSERT_TRUE(is_in_session("a") && is_in_session("b"));
  Process ls(folder, "ls", PEERD_PROGRAM, {"ls", "--interface", "lo"});
  ASSERT_EQ(ls.exit_code(10), 0) << ls.err();
  EXPECT_THAT(ls.out(), testing::ContainsRegex(world + "-open  \\(session [0-9a-f]+, open\\)"));
  EXPECT_THAT(ls.out(), testing::ContainsRegex(world + "  \\(session [0-9a-f]+\\)"));
  Process open = join("open", world, {"--open"});
  EXPECT_EQ(open.exit_code(10), 2);
  EXPECT_THAT(open.err(), HasSubstr("\" is sealed"));
  Process sealed = join("sealed", world + "-open");
  EXPECT_EQ(sealed.exit_code(10), 2);
  EXPECT_THAT(sealed.err(), HasSubstr("\" is open: whoever reaches this network"));
  ASSERT_TRUE(keys::read_or_make_key(folder / "own.key"));
  Process keyed = join("keyed", world + "-open", {"--key", (folder / "own.key").string()});
  EXPECT_EQ(keyed.exit_code(10), 2);
  EXPECT_THAT(keyed.err(), HasSubstr("that is not the world of your key"));
  EXPECT_THAT(keyed.err(), testing::Not(HasSubstr("--open"))) << "nobody who has a key is told to do without";
}

// Anybody can answer that he is in a world of that name.
TEST_F(Joining, WhoHasTheKeyFindsTheOthersWhoHaveIt) {
  folder.write("other.wrl", "#VRML V2.0 utf8\nDEF OTHER Transform { }\n");
  ASSERT_TRUE(keys::read_or_make_key(folder / "other.key"));
  const auto run_other = [&](const std::string& name, const Words& more) {
    Words words{"run",
                "--world",
                (folder / "other.wrl").string(),
                "--port",
                std::to_string(own_port(14)),
                "--world-name",
                world,
                "--id",
                "1"};
    words.insert(words.end(), more.begin(), more.end());
    return start(name, words);
  };
  Process open = run_other("open", {"--open"}), keyed = run_other("keyed", {"--key", (folder / "other.key").string()});
  // On the same computer, with the same number, of a session with the same number.
  Process like = run("like", world, {"--id", "1", "--key", (folder / "other.key").string()});
  Process a = run("a", world, {"--id", "1"});
  ASSERT_TRUE(is_in_session("a") && is_in_session("open") && is_in_session("like")) << a.err() << like.err();
  Process c = join("c", world);
  ASSERT_TRUE(is_in_session("c")) << c.err();
  EXPECT_EQ(world_of("c"), world_of("a")) << c.err();
}

TEST_F(Joining, APeerCanBeHidden) {
  Process a = run("a", world, {"--set", "transport.discoverable=false"});
  ASSERT_TRUE(is_in_session("a"));
  Process c = join("c", world);
  EXPECT_EQ(c.exit_code(10), 3);
}

}  // namespace peerd::join_test
