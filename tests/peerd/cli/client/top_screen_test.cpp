#include "peerd/cli/client/top_screen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace peerd::top_screen_test {

using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

PeerSample sample(double at_s, int datagrams_in, int objects) {
  PeerSample made;
  made.at_s = at_s;
  made.status = ordered_json::parse(R"({"peer":{"id":1,"name":"ada"},"session":{"clock_error_ms":0.25},
    "world_time_s":12.34,"since_start_s":null,"members":[{"id":2,"name":"ben"}],"counters":{}})");
  made.status["counters"]["datagrams_in"] = datagrams_in;
  made.peers = ordered_json::parse(R"({"clock":{"follows":1},"regions":[{"drops":{"malformed":3}}],"peers":[
    {"id":2,"name":"ben","delay_ms":1,"round_trip_ms":2,"clock_ahead_ms":0,"clock_error_ms":0,"loss_in":0,"loss_out":0,
     "datagrams_in":5,"bytes_in":500,"drops":{}}]})");
  made.objects["objects"] = ordered_json::array();
  for (int i = 0; i < objects; ++i) {
    ordered_json object{{"path", "O" + std::to_string(i)},
                        {"owner", i % 2 + 1},
                        {"driven", false},
                        {"position_m", {0, 0, 0}},
                        {"velocity_m_s", {i, 0, 0}}};
    if (i == 0) object["ghost_error_m"] = 0.5;
    made.objects["objects"].push_back(object);
  }
  return made;
}

std::ptrdiff_t lines_of(const std::string& screen) { return std::ranges::count(screen, '\n'); }

TEST(TopScreen, RatesAreThoseBetweenTwoSamples) {
  const PeerSample now = sample(12.0, 150, 0);
  EXPECT_THAT(top_screen(sample(10.0, 100, 0), now, {}), HasSubstr("datagrams in 25 "));
  EXPECT_THAT(top_screen(std::nullopt, now, {}), HasSubstr("datagrams in - "));
  EXPECT_THAT(top_screen(sample(10.0, 151, 0), now, {}), HasSubstr("datagrams in - ")) << "the peer has restarted";
  EXPECT_THAT(top_screen(sample(12.0, 100, 0), now, {}), HasSubstr("datagrams in - ")) << "no time has passed";
}

TEST(TopScreen, SaysWhoItIsAndWhatItDrops) {
  const std::string screen = top_screen(std::nullopt, sample(0, 0, 1), {24, 200});
  EXPECT_THAT(screen, HasSubstr("ada (id 1)   session time within 0.250 ms   world time 12.3 s   since the start -   "
                                "with 1 other peer\n"));
  EXPECT_THAT(screen, HasSubstr("dropped: 3 malformed\n"));
  EXPECT_THAT(screen, HasSubstr("\nben"));
}

TEST(TopScreen, ObjectsWithErrorsComeFirstThenTheFastest) {
  const std::string screen = top_screen(std::nullopt, sample(0, 0, 4), {40, 120});
  const auto at = [&](const char* name) { return screen.find(std::string("\n") + name); };
  EXPECT_LT(at("O0"), at("O3"));
  EXPECT_LT(at("O3"), at("O2"));
  EXPECT_LT(at("O2"), at("O1"));
  EXPECT_THAT(screen, Not(HasSubstr("more objects")));
}

TEST(TopScreen, KeepsWithinAnyWindow) {
  for (std::size_t rows = 1; rows <= 60; ++rows) {
    for (const std::size_t columns : {1u, 7u, 80u}) {
      const std::string screen = top_screen(std::nullopt, sample(0, 0, 40), {rows, columns});
      EXPECT_LE(lines_of(screen), static_cast<std::ptrdiff_t>(rows));
      std::size_t longest = 0, begin = 0;
      for (std::size_t end = screen.find('\n'); end != std::string::npos; end = screen.find('\n', begin)) {
        longest = std::max(longest, end - begin);
        begin = end + 1;
      }
      EXPECT_LE(longest, columns);
    }
  }
  EXPECT_THAT(top_screen(std::nullopt, sample(0, 0, 40), {20, 80}), HasSubstr("and 30 more objects\n"));
}

}  // namespace peerd::top_screen_test
