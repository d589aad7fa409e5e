// The program itself, as a shell starts it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include <nlohmann/json.hpp>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::main_test {

using testing::HasSubstr;
using testing_support::kMovingBox;
using testing_support::kStillWorld;
using testing_support::Program;
using testing_support::Said;
using testing_support::text_of;

constexpr std::string_view kMoving = R"(#VRML V2.0 utf8
DEF CLOCK TimeSensor { loop TRUE }
DEF PATH PositionInterpolator { key [ 0, 1 ] keyValue [ 0 0 0, 1 0 0 ] }
DEF CAR Transform { children Shape { geometry Box {} } }
ROUTE CLOCK.fraction_changed TO PATH.set_fraction
ROUTE PATH.value_changed TO CAR.set_translation
)";

struct NumberCase {
  const char *words, *refused;
  friend void PrintTo(const NumberCase& c, std::ostream* out) { *out << c.words; }
};
class Numbers : public Program, public testing::WithParamInterface<NumberCase> {};

TEST_P(Numbers, OutOfRangeAreWrongUse) {
  folder.write("w.wrl", kMoving);
  const Said said = run(GetParam().words);
  EXPECT_EQ(said.exit_code, 2) << said.err;
  EXPECT_EQ(said.out, "");
  EXPECT_THAT(said.err, HasSubstr(GetParam().refused));
}
INSTANTIATE_TEST_SUITE_P(
    Table, Numbers,
    testing::Values(
        NumberCase{"check --at nan w.wrl", "--at: nan is no finite number"},
        NumberCase{"check --at inf w.wrl", "--at: inf is no finite number"},
        NumberCase{"check --at=-inf w.wrl", "--at: -inf is no finite number"},
        NumberCase{"check --at 1e400 w.wrl", "--at: 1e400 is out of range"},
        NumberCase{"check --at 1e308 w.wrl", "--at: 1e308 is out of range: -1e+12 to 1e+12"},
        NumberCase{"check --at '' w.wrl", "--at: an empty text is no finite number"},
        NumberCase{"check --at 0x10 w.wrl", "--at: 0x10 is no finite number"},
        NumberCase{"collide --at nan w.wrl", "--at: nan is no finite number"},
        NumberCase{"collide --until inf w.wrl", "--until: inf is no finite number"},
        NumberCase{"collide --until 1 --hz nan w.wrl", "--hz: nan is no finite number"},
        NumberCase{"collide --until 1 --hz 0 w.wrl", "--hz: 0 is out of range"},
        NumberCase{"bake --expansion 0 w.wrl", "--expansion: 0 is out of range: 1 to 1000000"},
        NumberCase{"sim --seed -1 s.toml", "--seed: -1 is out of range"},
        NumberCase{"sim --seed 99999999999999999999 s.toml", "--seed: 99999999999999999999 is out of range"},
        NumberCase{"sim --seed 9223372036854775808 s.toml", "--seed: 9223372036854775808 is out of range"},
        NumberCase{"sim --chaos 1 --chaos-seconds 21.9", "--chaos-seconds: 21.9 is out of range: 22 to 3600"},
        NumberCase{"sim --repeat 0 s.toml", "--repeat: 0 is out of range: 1 to 10000"},
        NumberCase{"scenario --repeat nan s.toml", "--repeat: nan is no whole number"},
        NumberCase{"run --world w.wrl --id 0", "--id: 0 is out of range: 1 to 4294967295"},
        NumberCase{"run --world w.wrl --port 65536", "--port: 65536 is out of range: 1 to 65535"},
        NumberCase{"doctor --port -1", "--port: -1 is out of range: 1 to 65535"},
        NumberCase{"ctl key --value 2147483648", "--value: 2147483648 is out of range: 0 to 2147483647"},
        NumberCase{"ctl key --value 1 --state nan", "--state: nan is no whole number"},
        NumberCase{"ctl pose CAR 0 nan 0", "position: nan is no finite number"},
        NumberCase{"ctl pose CAR 0 0 1e10", "position: 1e10 is out of range: -1000000000 to 1000000000"},
        NumberCase{"ctl pose CAR 0 0 0 --orientation 0 0 0 inf", "--orientation: inf is no finite number"}));

// Each line prints something.
class Printing : public Program, public testing::WithParamInterface<const char*> {
 protected:
  Printing() {
    folder.write("w.wrl", kStillWorld);
    folder.write("s.toml", kMovingBox);
  }
};

TEST_P(Printing, ToAFullDeviceFails) {
  const Said said = run(std::string(GetParam()) + " >/dev/full");
  EXPECT_EQ(said.exit_code, 3);
  EXPECT_THAT(said.err, HasSubstr("error: standard output can't be written: "));
}
TEST_P(Printing, ToNothingFails) {
  const Said said = run(std::string(GetParam()) + " >&-");
  EXPECT_EQ(said.exit_code, 3);
  EXPECT_THAT(said.err, HasSubstr("error: standard output can't be written: "));
}
INSTANTIATE_TEST_SUITE_P(Table, Printing,
                         testing::Values("--help", "--version", "help", "help ctl pose", "version", "check w.wrl",
                                         "check --json w.wrl", "check w.wrl --write copy.wrl", "collide w.wrl",
                                         "collide --json --until 1 w.wrl", "bake w.wrl", "sim s.toml",
                                         "sim --json s.toml", "sim --json none.toml", "doctor --interface lo",
                                         "run --json"));

TEST_F(Program, AClosedOutputIsNoFile) {
  folder.write("w.wrl", kStillWorld);
  EXPECT_EQ(run("check w.wrl --write copy.wrl >&-").exit_code, 3);
  EXPECT_EQ(run("check copy.wrl").exit_code, 0) << "nothing else got into the file: " << text_of(folder / "copy.wrl");
  EXPECT_EQ(run("bake none.wrl >&-").exit_code, 2) << "nothing was to be printed";
}

struct WrongUse {
  const char *words, *sentence;
  friend void PrintTo(const WrongUse& c, std::ostream* out) { *out << c.words; }
};
class WrongUses : public Program, public testing::WithParamInterface<WrongUse> {};

TEST_P(WrongUses, AreExplained) {
  folder.write("w.wrl", kStillWorld);
  folder.write("s.toml", kMovingBox);
  const Said said = run(GetParam().words);
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_EQ(said.out, "");
  EXPECT_THAT(said.err, HasSubstr(GetParam().sentence));
}
INSTANTIATE_TEST_SUITE_P(
    Table, WrongUses,
    testing::Values(WrongUse{"", "\nSubcommands:\n"}, WrongUse{"", "error: which command? peerd needs one"},
                    WrongUse{"ctl", "which command? peerd ctl needs one"},
                    WrongUse{"rnu", "peerd has no command rnu; did you mean run?\nSee peerd --help"},
                    WrongUse{"ctl leav", "peerd ctl has no command leav; did you mean leave?\nSee peerd ctl --help"},
                    WrongUse{"help smi", "peerd has no command smi; did you mean sim?"},
                    WrongUse{"help sim x", "peerd sim has no command x"},
                    WrongUse{"check --jsno w.wrl", "peerd check has no option --jsno; did you mean --json?"},
                    WrongUse{"collide w.wrl --untill=5", "peerd collide has no option --untill; did you mean --until?"},
                    WrongUse{"check w.wrl v.wrl", "peerd check takes no further word: v.wrl"},
                    WrongUse{"check", "world is required"},
                    WrongUse{"sim s.toml --set network.latency=5",
                             "unknown key network.latency; did you mean network.latency_ms?"},
                    WrongUse{"collide --at 1 --until 0 w.wrl", "--until 0 is before --at 1"}));

class JsonErrors : public Program, public testing::WithParamInterface<const char*> {};

TEST_P(JsonErrors, AreOneObject) {
  folder.write("bad.wrl", "#VRML V2.0 utf8\nTransform {\n");
  folder.write("bad.toml", "world = 5\n");
  folder.write("of-bad-world.toml", "world = \"bad.wrl\"\n[peer.a]\nid = 1\n");
  const Said said = run(GetParam());
  EXPECT_THAT(said.exit_code, testing::AnyOf(1, 2, 3));
  const auto json = nlohmann::json::parse(said.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << said.out;
  EXPECT_EQ(json["good"], false);
  ASSERT_TRUE(json["errors"].is_array() && !json["errors"].empty()) << said.out;
  const auto& error = json["errors"][0];
  EXPECT_TRUE(error["file"].is_string() && error["line"].is_number() && error["column"].is_number()) << said.out;
  EXPECT_NE(error["message"], "");
}
INSTANTIATE_TEST_SUITE_P(Table, JsonErrors,
                         testing::Values("run --json", "run --json --world none.wrl",
                                         "record --json --world none.wrl --out c", "run --json -c bad.toml",
                                         "run --json -c of-bad-world.toml", "replay --json none",
                                         "replay --json bad.toml", "sim --json none.toml", "sim --json bad.toml",
                                         "sim --json of-bad-world.toml", "scenario --json none.toml",
                                         "check --json none.wrl", "check --json bad.wrl", "collide --json none.wrl",
                                         "collide --json bad.wrl", "bake --json none.wrl", "bake --json bad.wrl",
                                         "doctor --json -c none.toml", "doctor --json --set transport.ttl=nan",
                                         "ctl --json --control none status", "ctl --json leav", "check --json",
                                         "rnu --json", "check --json --at nan bad.wrl"));

}  // namespace peerd::main_test
