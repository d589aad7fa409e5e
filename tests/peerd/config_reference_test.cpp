// docs/reference/configuration.md is the reference of the scenario language: it and the parser know the same keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "peerd/peer/config/link_settings.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::config::config_reference_test {

const std::filesystem::path kReference = PEERD_SOURCE_DIR "/docs/reference/configuration.md";
const std::filesystem::path kParsers[] = {PEERD_SOURCE_DIR "/peerd/peer/config", PEERD_SOURCE_DIR "/peerd/peer/motion"};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

using Words = std::vector<std::string>;

// The words that stand in backquotes.
Words quoted(const std::string& text) {
  Words words;
  const std::regex quote("`([^`]*)`");
  for (std::sregex_iterator at(text.begin(), text.end(), quote), end; at != end; ++at) words.push_back((*at)[1]);
  return words;
}

// A table of the reference, by how its heading begins: where its keys stand, and settings with which they may.
struct Section {
  const char *heading, *prefix;
  std::vector<Words> around = {{}};  // one of these
};
const Section kSections[] = {
    {"### Top level", ""},
    {"### `[replication]`", "replication."},
    {"### `[decisions]`", "decisions."},
    {"### `[relay]`", "relay."},
    {"### `[baseline]`", "baseline."},
    {"### `[collision]`", "collision."},
    {"### `[regions]`", "regions."},
    {"### `[peer.NAME]`", "peer.a."},
    {"#### Formulas", "motion.CAR."},
    {"#### `waypoints` or `track`",
     "motion.CAR.",
     {{}, {"motion.CAR.waypoints=[[0, 0, 0, 0], [1, 1, 0, 0], [2, 0, 0, 0]]"}}},
    {"#### `walk`", "motion.CAR.walk.", {{"motion.CAR.walk.within_m=[-20, -20, 20, 20]"}}},
    {"#### `drive`", "motion.CAR.drive."},
    {"#### `flock`", "motion.CAR.flock.", {{"motion.CAR.flock.within_m=[-9, -9, -9, 9, 9, 9]"}}},
    {"#### `physics`", "motion.CAR.physics."},
    {"#### Beside these keys", "motion.CAR.", {{}, {"motion.CAR.drive={}"}}},
    {"### `[peer.NAME.feed]`", "peer.a.feed."},
    {"### `[peer.NAME.viewpoint]`", "peer.a.viewpoint."},
    {"### `[[peer.NAME.view]]`", "peer.a.view.0.", {{"peer.a.view=[{far_m = 9}]"}}},
    {"### `[[peer.NAME.key]]`",
     "peer.a.key.0.",
     {{"peer.a.key=[{at_s = 1, key = \"w\"}]"}, {"peer.a.key=[{at_s = 1, value = 87}]"}}},
    {"### `[control]`", "control."},
    {"### `[log]`", "log."},
    {"### `[gateway]`", "gateway."},
    {"### `[network]`", "network."},
    {"### `[[network.island]]`", "network.island.0.", {{"network.island=[{peers = [\"c\"]}]"}}},
    {"### `[transport]`",
     "transport.",
     {{}, {"transport.nats=[\"nats://h\"]"}, {"transport.nats=[\"nats://h\"]", "transport.nats_tls_key=peer.key"}}},
    {"### `[event.NAME]`",
     "event.e.",
     {{"event.e={at_s = 1, kind = \"network\", loss = 0.1}"},
      {"event.e={at_s = 1, kind = \"kill\", peer = \"b\"}"},
      {"event.e={at_s = 1, kind = \"partition\", groups = [[\"b\"]]}"},
      {"event.e={at_s = 1, kind = \"key\", peer = \"b\"}"},
      {"event.e={at_s = 1, kind = \"add\", peer = \"b\"}"},
      {"event.e={at_s = 1, kind = \"remove\", peer = \"b\"}"},
      {"event.e={at_s = 1, kind = \"move\", peer = \"b\", path = \"CAR\"}"},
      {"event.e={at_s = 1, kind = \"set\", peer = \"b\", path = \"CAR\", field = \"scale\"}"},
      {"event.e={at_s = 1, kind = \"data\", peer = \"b\", path = \"CAR\", value = \"1\"}"},
      {"event.e={at_s = 1, kind = \"send\", peer = \"b\", text = \"hello\"}"},
      {"event.d={at_s = 0, kind = \"partition\", groups = [[\"b\"]]}", "event.e={at_s = 1}"}}},
    {"### `[expect.NAME]`",
     "expect.e.",
     {{"expect.e={that = \"updates_sent\"}"},
      {"expect.e={that = \"updates_sent\", at_most = 1}"},
      {"expect.e={that = \"updates_sent\", at_least = -1}"}}},
};

class Reference : public testing::Test {
 protected:
  // Empty where the parser takes these settings.
  std::string error(Words sets) {
    const char* const text = R"(world = "some.wrl"
[network]
latency_ms = 5
[peer.a]
id = 1
owns = ["CAR"]
[peer.b]
id = 2
[peer.c]
id = 3
)";
    const auto scenario =
        read_scenario({.file = folder.write("s.toml", text), .configs = {}, .sets = std::move(sets), .seed = {}});
    if (!scenario) return scenario.error().text;
    return scenario->runs.size() == 1 || scenario->repeat > 1 ? "" : "one value of a list has swept";
  }

  testing_support::ScratchFolder folder;
};

// Each example, set by its dotted name, is taken; a list among them is one value.
TEST_F(Reference, EveryExampleIsOne) {
  std::istringstream lines(text_of(kReference));
  const Section* section = nullptr;
  std::size_t rows = 0;
  std::set<std::string> seen;
  const std::regex row("\\| (`.*) \\| (`[^|]*`) \\|");
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) {
      section = nullptr;
      for (const Section& s : kSections) {
        if (line.starts_with(s.heading)) section = &s;
      }
      if (section != nullptr) seen.insert(section->heading);
    }
    std::smatch parts;
    if (section == nullptr || !std::regex_match(line, parts, row)) continue;
    ++rows;
    const std::string example = quoted(parts[2]).front();
    const std::size_t equals = example.find(" = ");
    ASSERT_NE(equals, std::string::npos) << line;
    const std::string named = line.substr(0, line.find(" | "));
    EXPECT_THAT(quoted(named), testing::Contains(example.substr(0, equals))) << line;
    for (const std::string& key : quoted(named)) {
      // Several keys may share a row. The example is the first one's then, and of the others only the names are
      // checked.
      const bool shown = key == example.substr(0, equals);
      Words errors;
      for (Words sets : section->around) {
        sets.push_back(section->prefix + key + "=" + example.substr(equals + 3));
        errors.push_back(error(std::move(sets)));
      }
      const auto good = [&](const std::string& e) {
        return e.empty() || (!shown && e.find("unknown key") == std::string::npos);
      };
      EXPECT_TRUE(std::ranges::any_of(errors, good)) << line << '\n' << errors.front();
    }
  }
  EXPECT_EQ(seen.size(), std::size(kSections)) << "a heading of the reference has another name";
  EXPECT_GT(rows, 130u);
}

// Each key that the parser asks for is described. It asks by literals, so its text says which.
TEST_F(Reference, EveryKeyIsDescribed) {
  const std::string reference = text_of(kReference);
  const std::regex asked(
      "(?:read|read_word|rows|word_rows|tables?|has|require|peer|table_or_empty)\\((?:reader, |root, )?\"([a-z_]+)\"");
  std::set<std::string> keys;
  for (const LinkKey& key : kLinkKeys) keys.emplace(key.name);
  for (const auto& folder_of_parsers : kParsers) {
    for (const auto& file : std::filesystem::directory_iterator(folder_of_parsers)) {
      if (file.path().extension() != ".cpp") continue;
      const std::string text = text_of(file);
      for (std::sregex_iterator at(text.begin(), text.end(), asked), end; at != end; ++at) keys.insert((*at)[1]);
    }
  }
  EXPECT_GT(keys.size(), 130u);
  for (const std::string& key : keys) {
    const bool described = reference.find("| `" + key + "`") != std::string::npos ||
                           reference.find("#### `" + key + "`") != std::string::npos ||
                           std::regex_search(reference, std::regex("`\\[+([A-Za-z]+\\.)*" + key + "(\\.|\\])")) ||
                           std::regex_search(reference, std::regex("\n\\| [^|]*`" + key + "`[^|]*\\|"));
    EXPECT_TRUE(described) << key << " is not in docs/reference/configuration.md";
  }
}

}  // namespace peerd::config::config_reference_test
