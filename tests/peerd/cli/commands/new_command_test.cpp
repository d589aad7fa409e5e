#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <tuple>

#include <nlohmann/json.hpp>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::new_command_test {

using testing::HasSubstr;
using testing_support::Program;
using testing_support::Said;
using testing_support::text_of;

TEST_F(Program, NewWorldsRun) {
  const Said made = run("new first");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("peerd sim first/first.toml\n"));
  const Said checked = run("check first/first.wrl");
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_EQ(checked.err, "") << "not even a warning";
  const Said simulated = run("sim first/first.toml --json");
  EXPECT_EQ(simulated.exit_code, 0) << simulated.err;
  EXPECT_EQ(simulated.err, "");
  const auto summary = nlohmann::json::parse(simulated.out);
  EXPECT_GE(summary["runs"][0]["collisions"]["shared"]["decided"], 3) << "the ball meets the car again and again";
}

TEST_F(Program, NewWorldsHaveAName) {
  EXPECT_EQ(run("new . --name mine").exit_code, 0);
  EXPECT_THAT(text_of(folder / "mine.toml"), HasSubstr("world = \"mine.wrl\""));
  EXPECT_THAT(text_of(folder / "mine.wrl"), testing::Not(HasSubstr("NAME")));
}

TEST_F(Program, NewWorldsReplaceNothing) {
  folder.write("mine.toml", "precious");
  const Said said = run("new . --name mine");
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_THAT(said.err, HasSubstr("mine.toml already"));
  EXPECT_EQ(text_of(folder / "mine.toml"), "precious");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "mine.wrl"));
}

TEST_F(Program, NewWorldsNeedAGoodNameAndAPlace) {
  for (const char* name : {"--name 'a b'", "--name ../up", "--name=-x"}) {
    EXPECT_EQ(run(std::string("new . ") + name).exit_code, 2) << name;
  }
  folder.write("file", "");
  EXPECT_EQ(run("new file/below").exit_code, 3);
}

constexpr const char* kObj =
    "mtllib m/parts.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\no left arm\nusemtl a\nf 1 2 3\no crate\nf 1 2 3\n";

TEST_F(Program, WorldsOfOtherFormatsAreBegunWithAllThatTheyName) {
  std::filesystem::create_directories(folder.path() / "from/m");
  folder.write("from/arm.obj", kObj);
  folder.write("from/m/parts.mtl", "newmtl a\nKd 1 0 0\n");
  const Said made = run("new mine --from from/arm.obj");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("wrote mine/arm.obj, mine/arm.peerd.toml and mine/mine.toml\n"));
  EXPECT_THAT(made.out, HasSubstr("peerd run -c mine/mine.toml --peer a --view\n"));
  EXPECT_EQ(text_of(folder / "mine/arm.obj"), kObj);
  EXPECT_EQ(text_of(folder / "mine/m/parts.mtl"), "newmtl a\nKd 1 0 0\n");
  EXPECT_THAT(text_of(folder / "mine/arm.peerd.toml"), HasSubstr("\n#   \"left arm\"\n#   crate\n"));
  const Said collided = run("collide mine/arm.obj");
  EXPECT_EQ(collided.exit_code, 0) << collided.err;
  EXPECT_THAT(collided.out, HasSubstr("\"left arm\" - crate (witness): colliding\n"));
  const Said simulated = run("sim mine/mine.toml --json");
  EXPECT_EQ(simulated.exit_code, 0) << simulated.err;
}

TEST_F(Program, WorldsKeepNamesOfAnyKind) {
  std::filesystem::create_directories(folder.path() / "from");
  const std::string name = "my\"FILE\\\nNAME.off";
  folder.write("from/" + name, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const Said made = run("new . --name FILE --from 'from/" + name + "'");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(text_of(folder / "FILE.toml"), HasSubstr("world = \"my\\\"FILE\\\\\\nNAME.off\"\n"));
  EXPECT_THAT(text_of(folder / "FILE.toml"), HasSubstr("`peerd run -c FILE.toml --peer a`"));
  const Said simulated = run("sim FILE.toml --json");
  EXPECT_EQ(simulated.exit_code, 0) << simulated.err;
}

TEST_F(Program, WorldsOfVrmlAreBegunWithAllThatTheyShowAndSound) {
  for (const char* const place : {"from/parts", "from/images", "from/parts/own"}) {
    std::filesystem::create_directories(folder.path() / place);
  }
  folder.write("from/w.wrl",
               "#VRML V2.0 utf8\nDEF A Transform { children Shape { appearance Appearance { texture ImageTexture { url "
               "[ \"images/a%20b.png\" \"http://example.org/a.png\" \"images/gone.png\" ] } } geometry Box { } } }\n"
               "Sound { source AudioClip { url \"images/../bell.wav\" } }\nInline { url \"parts/arm.wrl\" }\n"
               "Background { backUrl \"../sky.png\" frontUrl \"sky.png\" topUrl \"/sky.png\" leftUrl [ \"../sky.png\" "
               "\"bell.wav\" ] }\n"
               "Anchor { url \"other.wrl#HERE\" }\n");
  folder.write("from/parts/arm.wrl",
               "#VRML V2.0 utf8\nPROTO P [ exposedField MFString url \"own/p.png\" ] { Shape { appearance Appearance { "
               "texture ImageTexture { url IS url } } } }\nP { }\n");
  for (const char* const file : {"from/images/a b.png", "from/bell.wav", "from/parts/own/p.png", "sky.png"}) {
    folder.write(file, file);
  }
  const Said made = run("new mine --from from/w.wrl");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  for (const char* const file : {"images/a b.png", "bell.wav", "parts/arm.wrl", "parts/own/p.png"}) {
    EXPECT_EQ(text_of(folder / "mine" / file), text_of(folder / "from" / file)) << file;
  }
  EXPECT_EQ(made.err,
            "warning: from/w.wrl names ../sky.png, which is not copied: it is outside of the world's folder\n"
            "warning: from/w.wrl names /sky.png, which is not copied: its path is one of this machine\n"
            "warning: from/w.wrl names sky.png, which is not copied: there is no such file\n");
}

TEST_F(Program, NothingIsWrittenWhereAFileOfTheWorldIsInTheWay) {
  std::filesystem::create_directories(folder.path() / "from");
  std::filesystem::create_directories(folder.path() / "mine");
  folder.write("from/w.wrl",
               "#VRML V2.0 utf8\nSound { source AudioClip { url \"bell.wav\" } }\nSound { source AudioClip { url "
               "\"mine.toml\" } }\n");
  folder.write("from/mine.toml", "");
  folder.write("from/bell.wav", "");
  folder.write("mine/bell.wav", "mine");
  EXPECT_THAT(run("new mine --from from/w.wrl").err, testing::HasSubstr("there is a file mine/bell.wav already"));
  EXPECT_FALSE(std::filesystem::exists(folder / "mine/w.wrl"));
  std::filesystem::remove(folder / "mine/bell.wav");
  EXPECT_THAT(run("new mine --from from/w.wrl").err, testing::HasSubstr("mine.toml, which peerd new writes itself"));
  EXPECT_FALSE(std::filesystem::exists(folder / "mine/w.wrl"));
}

TEST_F(Program, AWorldBehindALinkIsCopiedFromWhereTheLinkIs) {
  for (const char* const place : {"from", "store"}) std::filesystem::create_directories(folder.path() / place);
  folder.write("store/x", "v 0 0 0\nv 1 0 0\nv 0 0 1\nmtllib a.mtl\nusemtl a\nf 1 2 3\n");
  folder.write("from/a.mtl", "newmtl a\n");
  std::filesystem::create_symlink("../store/x", folder / "from/w.obj");
  const Said made = run("new mine --from from/w.obj");
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(text_of(folder / "mine/a.mtl"), "newmtl a\n");
}

TEST_F(Program, ASideFileThatIsThereGoesWithTheWorld) {
  std::filesystem::create_directories(folder.path() / "from");
  folder.write("from/a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  folder.write("from/a.peerd.toml", "unit = \"mm\"\n");
  ASSERT_EQ(run("new mine --from from/a.off").exit_code, 0);
  EXPECT_EQ(text_of(folder / "mine/a.peerd.toml"), "unit = \"mm\"\n");
  // Beside a world that would share it, it has the whole name.
  std::filesystem::create_directories(folder.path() / "full");
  folder.write("full/a.wrl", "#VRML V2.0 utf8\n");
  ASSERT_EQ(run("new full --from from/a.off").exit_code, 0);
  EXPECT_EQ(text_of(folder / "full/a.off.peerd.toml"), "unit = \"mm\"\n");
}

TEST_F(Program, WorldsThatCannotBeCopiedLeaveNothingBehind) {
  std::filesystem::create_directories(folder.path() / "from");
  folder.write("from/arm.obj", "mtllib ../parts.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nusemtl a\nf 1 2 3\n");
  folder.write("parts.mtl", "newmtl a\n");
  folder.write("from/bad.obj", "f 1 2 3\n");
  for (const auto& [file, exit_code, why] : {std::tuple{"from/arm.obj", 2, "parts.mtl, which is outside of its folder"},
                                             {"from/bad.obj", 1, "from/bad.obj has errors"},
                                             {"from/none.obj", 2, "no such file"}}) {
    const Said said = run(std::string("new mine --from ") + file);
    EXPECT_EQ(said.exit_code, exit_code) << file;
    EXPECT_THAT(said.err, HasSubstr(why));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "mine")) << file;
  }
  folder.write("parts.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  std::filesystem::create_directories(folder.path() / "here");
  folder.write("here/parts.peerd.toml", "precious");
  EXPECT_EQ(run("new here --from parts.off").exit_code, 2);
  EXPECT_EQ(text_of(folder / "here/parts.peerd.toml"), "precious");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "here/parts.off"));
}

}  // namespace peerd::new_command_test
