// An object that rests on another peer's, or pushes it, ends alike at all peers, whoever owns what, and whoever
// decides.
#include <gtest/gtest.h>

#include <map>

#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::lasting_contacts_test {

using peerd::testing_support::ScratchFolder;
using testing_support::Ran;
using testing_support::run_scenario;

const std::string kDead = " collisionResponse CollisionResponse { responseType 2 restitution 0 } ";

std::string mover(const std::string& name, const std::string& at, const std::string& shape) {
  return "DEF " + name + " Transform { translation " + at + kDead + " children Shape { geometry " + shape + " } }\n";
}
std::string meet(const std::string& a, const std::string& b) {
  return "CollisionInterest { objectPath \"" + a + "\" interests \"" + b + "\" collisionType 1 }\n" +
         "CollisionInterest { objectPath \"" + b + "\" interests \"" + a + "\" collisionType 1 }\n";
}

// FIRST and SECOND, of a peer each, and how physics moves them; null: it does not.
struct Scene {
  const char* name;
  std::string world;
  const char *first_law, *second_law;
};
const Scene kRests = {"Rests",
                      "DEF FIRST Transform { children Shape { geometry Box { size 4 1 4 } } }\n" +
                          mover("SECOND", "0 3 0", "Sphere { radius 0.5 }") +
                          "CollisionInterest { objectPath \"SECOND\" interests \"FIRST\" collisionType 1 }\n",
                      nullptr, "physics = { velocity = [0, 0, 0], acceleration = [0, -9.81, 0] }"};
const Scene kPushes = {"Pushes",
                       mover("FIRST", "0 0 0", "Box { size 1 1 1 }") + mover("SECOND", "3 0 0", "Box { size 1 1 1 }") +
                           meet("FIRST", "SECOND"),
                       "physics = { velocity = [0, 0, 0], acceleration = [2, 0, 0] }",
                       "physics = { velocity = [0, 0, 0], acceleration = [0, 0, 0] }"};

struct Variation {
  Scene scene;
  const char* policy;
  bool first_is_lower;  // of the owners' ids
  double latency_ms;
};

void PrintTo(const Variation& v, std::ostream* out) {
  *out << v.scene.name << ' ' << v.policy << ' ' << v.first_is_lower << ' ' << v.latency_ms;
}

class LastingContacts : public testing::TestWithParam<Variation> {
 protected:
  static Ran run(const Variation& v) {
    const ScratchFolder folder;
    folder.write("world.wrl", "#VRML V2.0 utf8\n" + v.scene.world);
    std::string text = "world = \"world.wrl\"\nduration_s = 8\nsample_hz = 20\n[decisions]\npolicy = \"";
    text += std::string(v.policy) + "\"\n";
    if (std::string_view(v.policy) == "server") text += "server = \"third\"\n";
    const auto peer = [&](const char* name, bool is_lower, const char* object, const char* law) {
      text += "[peer." + std::string(name) + "]\nid = " + (is_lower ? "1" : "2") + "\nowns = [\"" + object + "\"]\n";
      if (law != nullptr) text += "[peer." + std::string(name) + ".motion.\"" + object + "\"]\n" + law + "\n";
    };
    peer("one", v.first_is_lower, "FIRST", v.scene.first_law);
    peer("two", !v.first_is_lower, "SECOND", v.scene.second_law);
    text += "[peer.third]\nid = 3\n";
    return std::move(
        run_scenario(folder.write("s.toml", text), {"network.latency_ms=" + std::to_string(v.latency_ms)}).front());
  }
};

TEST_P(LastingContacts, EndAlikeAtAllPeers) {
  const Ran ran = run(GetParam());
  std::map<ObjectId, Vec3> truth;
  std::map<ObjectId, double> ghost_error_m;  // at the last sample
  double last_s = 0.0;
  for (const measure::GhostSample& s : ran.record.ghost_samples) last_s = std::max(last_s, s.t_s);
  for (const measure::GhostSample& s : ran.record.ghost_samples) {
    if (s.t_s < last_s) continue;
    truth[s.object] = s.truth.position;
    double& worst = ghost_error_m[s.object];
    worst = std::max(worst, (s.ghost.position - s.truth.position).norm());
  }
  ASSERT_EQ(truth.size(), 2u);
  const auto of = [&](const char* path) {
    for (const auto& o : ran.record.objects) {
      if (o.path == path) return o.object;
    }
    throw std::runtime_error(path);
  };
  const Vec3 first = truth[of("FIRST")], second = truth[of("SECOND")];
  for (const auto& [object, error_m] : ghost_error_m) EXPECT_LE(error_m, 1e-6);
  const std::string name = GetParam().scene.name;
  if (name == "Rests") {
    EXPECT_LE(first.norm(), 1e-6);
    EXPECT_LE((second - Vec3(0, 1, 0)).norm(), 1e-6);
  } else {
    EXPECT_LE((second - first - Vec3(1, 0, 0)).norm(), 1e-6);
    // They meet at sqrt(2) s at 2 sqrt(2) m/s, and go on with half of it and 1 m/s^2.
    const double since_s = last_s - std::sqrt(2.0);
    EXPECT_NEAR(first.x(), 2.0 + std::sqrt(2.0) * since_s + 0.5 * since_s * since_s, 1e-5);
  }
}

std::vector<Variation> variations() {
  std::vector<Variation> all;
  for (const Scene& scene : {kRests, kPushes}) {
    for (const char* const policy : {"id", "velocity", "expected-error", "field-of-view", "server"}) {
      for (const bool first_is_lower : {true, false}) {
        for (const double latency_ms : {0.0, 50.0, 200.0}) all.push_back({scene, policy, first_is_lower, latency_ms});
      }
    }
  }
  return all;
}
INSTANTIATE_TEST_SUITE_P(OfTwoOwners, LastingContacts, testing::ValuesIn(variations()), [](const auto& c) {
  std::string name = std::string(c.param.scene.name) + '_' + c.param.policy +
                     (c.param.first_is_lower ? "_12_" : "_21_") + std::to_string(static_cast<int>(c.param.latency_ms));
  std::erase(name, '-');
  return name;
});

}  // namespace peerd::sim::lasting_contacts_test
