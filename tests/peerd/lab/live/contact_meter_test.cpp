#include "peerd/lab/live/contact_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "peerd/lab/measure/amiss.hpp"
#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::contact_meter_test {

using Json = nlohmann::ordered_json;

// The numbers of a run in which peer a, seen by b, owns those objects.
Json run(const std::string& world, const std::string& owns, const std::string& scenario) {
  const testing_support::ScratchFolder folder;
  folder.write("w.wrl", "#VRML V2.0 utf8\n" + world);
  const auto file = folder.write(
      "s.toml", "world = \"w.wrl\"\nsample_hz = 10\n" + scenario +
                    "[network]\nlatency_ms = 50\n[peer.b]\nid = 2\n[peer.a]\nid = 1\nowns = [" + owns + "]\n");
  return sim::testing_support::run_scenario(file).front().summary;
}

std::string body(const std::string& name, const std::string& place, const std::string& response,
                 const std::string& geometry, const std::string& meets) {
  return "DEF " + name + " Transform { translation " + place +
         " collisionResponse CollisionResponse { responseType 2 " + response + " } children Shape { geometry " +
         geometry + " } }\nCollisionInterest { objectPath \"" + name + "\" interests [ \"" + meets +
         "\" ] collisionType 1 }\n";
}

double number(const Json& json, const char* pointer) { return json.at(Json::json_pointer(pointer)).get<double>(); }

// It parts from the floor with half of what it comes with, until that is too little for a flight of 1 ms.
TEST(ContactMeter, KnowsTheEnergyOfADroppedBall) {
  const Json row = run("DEF F Transform { translation 0 -0.5 0 children Shape { geometry Box { size 100 1 100 } } }\n" +
                           body("A", "0 1.5 0", "mass 2 restitution 0.5", "Sphere { radius 0.5 }", "F"),
                       "\"A\"", "duration_s = 4\n[motion.A]\nphysics = { acceleration = [0, -9.81, 0] }\n");
  EXPECT_EQ(row["energy_j"]["bodies"], 1);
  EXPECT_EQ(row["energy_j"]["driven"], false);
  EXPECT_EQ(number(row, "/energy_j/kinetic/start"), 0.0);
  EXPECT_NEAR(number(row, "/energy_j/kinetic/greatest"), std::pow(9.81 * 0.45, 2), 1e-6) << "0.45 s is sampled";
  EXPECT_EQ(number(row, "/energy_j/kinetic/end"), 0.0);
  EXPECT_NEAR(number(row, "/energy_j/potential/end"), -2.0 * 9.81, 1e-5);
  EXPECT_NEAR(number(row, "/energy_j/sum/greatest"), 0.0, 1e-9);
  double parts_m_s = std::sqrt(2.0 * 9.81);
  int contacts = 0;
  for (; contacts == 0 || 2.0 * parts_m_s >= 9.81e-3; ++contacts) parts_m_s *= 0.5;
  EXPECT_NEAR(number(row, "/energy_j/taken_by_rest"), parts_m_s * parts_m_s, 1e-7) << "of 2 kg";
  EXPECT_EQ(row["contacts"]["count"], contacts);
  EXPECT_EQ(row["contacts"]["last_s"], 0);
  EXPECT_EQ(row["contacts"]["at_rest_per_s"], 0);
  EXPECT_EQ(row["contacts"]["island_objects_max"], 1);
  EXPECT_GE(row["contacts"]["overlap"]["samples"], 79);
  EXPECT_LE(number(row, "/contacts/overlap/deepest/depth_m"), 1e-6);
  EXPECT_EQ(measure::amiss(Json::array({row})), std::vector<std::string>{});
}

TEST(ContactMeter, FindsWhatIsPlacedInSomethingElse) {
  const char* const kBox = "Box { size 1 1 1 }";
  const Json row = run(body("A", "0 0 0", "", kBox, "B") + body("B", "0.9 0.2 0", "", kBox, "A"), "\"A\", \"B\"",
                       "duration_s = 2\n");
  for (const char* of : {"overlap", "ghost_overlap"}) {
    SCOPED_TRACE(of);
    const Json& deepest = row["contacts"][of]["deepest"];
    EXPECT_NEAR(deepest["depth_m"].get<double>(), 0.1, 1e-6);
    EXPECT_EQ(deepest["between"].dump(), R"(["A","B"])");
    EXPECT_EQ(deepest["at_s"], 0.0);
  }
  EXPECT_EQ(row["contacts"]["ghost_overlap"]["deepest"]["observer"], "b");
  EXPECT_EQ(measure::amiss(Json::array({row})).size(), 1u) << "of one owner, so that latency explains nothing";
}

}  // namespace peerd::contact_meter_test
