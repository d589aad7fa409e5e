#include "peerd/daemon/embed/option_values.hpp"

#include <gmock/gmock.h>

#include "tests/must.hpp"

namespace peerd::embed::option_values_test {

using testing::Contains;
using testing::HasSubstr;

TEST(OptionValues, AreThoseOfThePeersCommand) {
  OptionValues values;
  for (const auto& [name, value] : {std::pair{"world", "/w.wrl"},
                                    {"name", "ada"},
                                    {"id", "7"},
                                    {"own", "CAR"},
                                    {"own", "CRATE"},
                                    {"set", "replication.order=2"},
                                    {"port", "4000"},
                                    {"open", "yes"},
                                    {"take-over", "yes"},
                                    {"store", "/s"},
                                    {"control", "/c"},
                                    {"view", "127.0.0.1:0"}}) {
    EXPECT_TRUE(values.set(name, value)) << name;
  }
  const auto options = must(values.peer_options());
  EXPECT_EQ(options.peer, "ada");
  EXPECT_TRUE(options.take_over);
  EXPECT_EQ(options.store.folder, "/s");
  EXPECT_EQ(options.control, "/c");
  EXPECT_EQ(options.view, "127.0.0.1:0");
  for (const char* set : {"world=\"/w.wrl\"", "peer.ada.id=7", "peer.ada.owns=[\"CAR\",\"CRATE\"]",
                          "transport.port=4000", "transport.sealed=false", "replication.order=2"}) {
    EXPECT_THAT(options.sets, Contains(set));
  }
}

TEST(OptionValues, HaveNoStoreNoSocketAndNoPageByThemselves) {
  OptionValues values;
  ASSERT_TRUE(values.set("world", "/w.wrl"));
  const auto options = must(values.peer_options());
  EXPECT_FALSE(options.store.is_wanted());
  EXPECT_EQ(options.control, "");
  EXPECT_EQ(options.view, std::nullopt);
  EXPECT_TRUE(options.log_to) << "a library does not print";
}

TEST(OptionValues, RefuseWhatIsNone) {
  OptionValues values;
  for (const auto& [name, value] : {std::pair{"colour", "red"},
                                    {"", ""},
                                    {"id", "0"},
                                    {"id", "-1"},
                                    {"id", "4294967296"},
                                    {"id", "7x"},
                                    {"port", "65536"},
                                    {"open", "maybe"},
                                    {"fresh", "1"}}) {
    EXPECT_FALSE(values.set(name, value)) << name << " " << value;
  }
}

TEST(OptionValues, SayWhichDoNotGoTogether) {
  const auto why = [](std::initializer_list<std::pair<const char*, const char*>> all) {
    OptionValues values;
    for (const auto& [name, value] : all) EXPECT_TRUE(values.set(name, value));
    const auto options = values.peer_options();
    return options ? "" : options.error().text;
  };
  EXPECT_THAT(why({{"name", "a"}}), HasSubstr("a configuration, a world"));
  EXPECT_THAT(why({{"world", "w"}, {"open", "yes"}, {"key", "k"}}), HasSubstr("open has no key"));
  EXPECT_THAT(why({{"config", "c"}, {"name", "a"}}), HasSubstr("without a configuration"));
  EXPECT_THAT(why({{"join", "town"}, {"world", "w"}}), HasSubstr("no file and no configuration"));
  EXPECT_THAT(why({{"from", "host:1"}, {"config", "c"}}), HasSubstr("no file and no configuration"));
  EXPECT_THAT(why({{"join", "town"}, {"world-name", "w"}}), HasSubstr("has its name"));
  EXPECT_THAT(why({{"invite", "peerd-invite-1:half"}}), HasSubstr("no whole invitation"));
  EXPECT_THAT(why({{"invite", "peerd-invite-1:half"}, {"open", "yes"}}), HasSubstr("no invitation"));
  EXPECT_EQ(why({{"config", "c"}, {"peer", "a"}}), "");
}

}  // namespace peerd::embed::option_values_test
