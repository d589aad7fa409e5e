// Contacts that peers predict, and that are none.
#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::predicted_contacts_test {

using testing_support::Ran;
using testing_support::run_scenario;

const std::string kWorlds = PEERD_SOURCE_DIR "/tests/sim/worlds/";

double worst_error_m(const Ran& ran, const std::string& observer, const std::string& path) {
  return ran.view(observer, path)["ghost_error_m"]["max"].get<double>();
}

// The striker turns, and its ghost goes straight on and hits a ball. Its owner sees that at the same tick. Else the
// ball's owner mends the ball, but only once it knows that the striker's owner, which is to decide, has found no
// contact.
TEST(PredictedContacts, OfAStrikerThatPassesByAreTakenBackAtOnce) {
  for (const int latency_ms : {20, 50, 100}) {
    SCOPED_TRACE(latency_ms);
    const Ran ran =
        run_scenario(kWorlds + "passing.toml", {"network.latency_ms=" + std::to_string(latency_ms)}).front();
    EXPECT_EQ(ran.summary["collisions"]["spurious"], 0);
    EXPECT_EQ(ran.updates("BALL"), 1u) << "its owner has nothing to mend";
    EXPECT_EQ(worst_error_m(ran, "a", "BALL"), 0.0) << "the striker's owner knows at once";
    EXPECT_GT(worst_error_m(ran, "c", "BALL"), 0.0) << "the others predict it until they know";
    EXPECT_LT(worst_error_m(ran, "c", "BALL"), 2.0 * (latency_ms + 2 * 17) / 1e3) << "at less than 2 m/s";
  }
}

}  // namespace peerd::sim::predicted_contacts_test
