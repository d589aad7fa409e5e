// An object that rests on another peer's, or pushes it, ends alike at all peers, whoever owns what, and whoever
// decides.
#include <gtest/gtest.h>

#include <cctype>
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

// FIRST and SECOND, of a peer each, and what moves them; null: nothing does. A peer joins at 3 s, so that it comes
// while they rest.
struct Scene {
  const char* name;
  std::string world;
  const char *first_law, *second_law;
  const char* events = "";
  // By what the end may differ from that of a run in which one peer owns both; the others agree on it in any case.
  double off_one_owner_m = 1e-6;
};

const std::string kBox = "Box { size 1 1 1 }";
const std::string kTable = "DEF FIRST Transform { children Shape { geometry Box { size 4 1 4 } } }\n" +
                           mover("SECOND", "0 3 0", "Sphere { radius 0.5 }") +
                           "CollisionInterest { objectPath \"SECOND\" interests \"FIRST\" collisionType 1 }\n";
const std::string kSideBySide =
    mover("FIRST", "0 0 0", kBox) + mover("SECOND", "1 0 0", kBox) + meet("FIRST", "SECOND");
const std::string kApart = mover("FIRST", "-1 0 0", kBox) + mover("SECOND", "1 0 0", kBox) + meet("FIRST", "SECOND");
const char* const kFalls = "physics = { velocity = [0, 0, 0], acceleration = [0, -9.81, 0] }";
const char* const kDrivenBy2 = "physics = { velocity = [0, 0, 0], acceleration = [2, 0, 0] }";
const char* const kFree = "physics = { velocity = [0, 0, 0], acceleration = [0, 0, 0] }";

const Scene kRests = {"Rests", kTable, nullptr, kFalls};
const Scene kPushes = {"Pushes",
                       mover("FIRST", "0 0 0", kBox) + mover("SECOND", "3 0 0", kBox) + meet("FIRST", "SECOND"),
                       kDrivenBy2, kFree};
const Scene kPresses = {"Presses", kSideBySide, kDrivenBy2,
                        "physics = { velocity = [0, 0, 0], acceleration = [-2, 0, 0] }"};
// The peer that decides knows before that FIRST comes: what met within its latency of a launch is inside it by then.
const Scene kPressesLater = {"PressesLater", kApart, kDrivenBy2,
                             "physics = { velocity = [0, 0, 0], acceleration = [-2, 0, 0], at_s = 5.5 }"};
// SECOND stands between FIRST and a wall, until it is driven more strongly than FIRST.
const Scene kDriveChanges = {"DriveChanges",
                             kApart + "DEF WALL Transform { translation 2 0 0 children Shape { geometry " + kBox +
                                 " } }\n" +
                                 "CollisionInterest { objectPath \"SECOND\" interests \"WALL\" collisionType 1 }\n",
                             kDrivenBy2, "physics = { velocity = [0, 0, 0], acceleration = [-3, 0, 0], at_s = 5.5 }"};
const Scene kSupportIsRemoved = {"SupportIsRemoved", kTable, nullptr, kFalls,
                                 "[event.away]\nat_s = 5.5\nkind = \"remove\"\npeer = \"third\"\npath = \"FIRST\"\n"};
// The owner of SECOND knows by updates alone how its table goes.
const Scene kSupportDrivesOff = {"SupportDrivesOff", kTable, "x = \"t < 5 ? 0 : 4 * (t - 5)\"", kFalls, "", 0.5};

struct Variation {
  Scene scene;
  const char* policy;
  bool first_is_lower;  // of the owners' ids
  double latency_ms;
  const char* approach = "dr+rcp+acpt";
  std::vector<std::string> sets{};
  const char* how = "";  // what these settings mean
};

void PrintTo(const Variation& v, std::ostream* out) {
  *out << v.scene.name << ' ' << v.policy << ' ' << v.first_is_lower << ' ' << v.latency_ms << ' ' << v.approach << ' '
       << v.how;
}

struct End {
  std::map<std::string, Vec3> truth;  // by path
  double ghost_error_m = 0.0;         // of any object that physics moves, at any peer
  std::size_t observers = 0;          // of SECOND
};

class LastingContacts : public testing::TestWithParam<Variation> {
 protected:
  static End run(const Variation& v, bool one_owner) {
    const ScratchFolder folder;
    folder.write("world.wrl", "#VRML V2.0 utf8\n" + v.scene.world);
    std::string text = "world = \"world.wrl\"\nduration_s = 9\nsample_hz = 20\n[decisions]\npolicy = \"";
    text += std::string(v.policy) + "\"\n";
    if (std::string_view(v.policy) == "server") text += "server = \"third\"\n";
    const auto peer = [&](const char* name, bool is_lower,
                          const std::vector<std::pair<std::string, const char*>>& owns) {
      text += "[peer." + std::string(name) + "]\nid = " + (is_lower ? "1" : "2") + "\nowns = [";
      for (const auto& [object, law] : owns) text += "\"" + object + "\", ";
      text += "]\n";
      for (const auto& [object, law] : owns) {
        if (law != nullptr) text += "[peer." + std::string(name) + ".motion.\"" + object + "\"]\n" + law + "\n";
      }
    };
    const std::pair<std::string, const char*> first = {"FIRST", v.scene.first_law},
                                              second = {"SECOND", v.scene.second_law};
    peer("one", v.first_is_lower, one_owner ? std::vector{first, second} : std::vector{first});
    peer("two", !v.first_is_lower,
         one_owner ? std::vector<std::pair<std::string, const char*>>{} : std::vector{second});
    text += "[peer.third]\nid = 3\n[peer.late]\nid = 4\n";
    text += "[event.joins]\nat_s = 3\nkind = \"join\"\npeer = \"late\"\n" + std::string(v.scene.events);
    std::vector<std::string> sets = v.sets;
    sets.push_back("network.latency_ms=" + std::to_string(v.latency_ms));
    sets.push_back("replication.approach=\"" + std::string(v.approach) + "\"");
    const Ran ran = std::move(run_scenario(folder.write("s.toml", text), sets).front());
    std::map<std::pair<PeerId, ObjectId>, measure::GhostSample> last;  // the instants differ where clocks do
    double end_s = 0.0;
    for (const measure::GhostSample& sample : ran.record.ghost_samples) {
      end_s = std::max(end_s, sample.t_s);
      const auto [at, is_new] = last.try_emplace({sample.observer, sample.object}, sample);
      if (at->second.t_s < sample.t_s) at->second = sample;
    }
    End end;
    std::map<ObjectId, std::string> paths;
    for (const auto& o : ran.record.objects) paths[o.object] = o.path;
    for (const auto& [who, sample] : last) {
      if (sample.t_s < end_s - 0.2) continue;  // the object is gone
      const std::string& path = paths.at(sample.object);
      end.truth[path] = sample.truth.position;
      if (path == "SECOND") ++end.observers;
      const bool by_physics = path == "SECOND" || v.scene.off_one_owner_m <= 1e-6;
      const double error_m = (sample.ghost.position - sample.truth.position).norm();
      if (by_physics) end.ghost_error_m = std::max(end.ghost_error_m, error_m);
    }
    return end;
  }
};

// The clocks of peers that lose datagrams are some milliseconds apart, so that what moves is seen at other places.
TEST_P(LastingContacts, EndAlikeAtAllPeers) {
  const Scene& scene = GetParam().scene;
  const std::string name = scene.name;
  const bool stands = name == "Rests" || name == "Presses", clocks_differ = std::string_view(GetParam().how) == "lossy";
  const End end = run(GetParam(), false), of_one_owner = run(GetParam(), true);
  EXPECT_EQ(end.observers, 3u);
  EXPECT_LE(end.ghost_error_m, stands || !clocks_differ ? 1e-6 : 0.2);
  for (const auto& [path, at] : end.truth) {
    ASSERT_TRUE(of_one_owner.truth.contains(path)) << path;
    EXPECT_LE((at - of_one_owner.truth.at(path)).norm(), stands || !clocks_differ ? scene.off_one_owner_m : 2.5)
        << path << " at " << at.transpose() << ", not " << of_one_owner.truth.at(path).transpose();
  }
  ASSERT_TRUE(end.truth.contains("SECOND"));
  const Vec3 second = end.truth.at("SECOND");
  if (name == "Rests") {
    EXPECT_LE((second - Vec3(0, 1, 0)).norm(), 1e-6);
  }
  if (name == "Presses") {
    EXPECT_LE((second - Vec3(1, 0, 0)).norm(), 1e-6);
  }
  if (name == "Pushes" && !clocks_differ) {
    EXPECT_LE((second - end.truth.at("FIRST") - Vec3(1, 0, 0)).norm(), 1e-6);
    // They meet at sqrt(2) s at 2 sqrt(2) m/s, and go on with half of it and 1 m/s^2.
    const double since_s = 9.0 - std::sqrt(2.0);
    EXPECT_NEAR(second.x(), 3.0 + std::sqrt(2.0) * since_s + 0.5 * since_s * since_s, 1e-5);
  }
  if (name == "DriveChanges" && !clocks_differ) {
    EXPECT_NEAR(second.x(), 1.0 - 0.25 * 3.5 * 3.5, 1e-5);
  }
  if (name == "SupportIsRemoved" || name == "SupportDrivesOff") {
    EXPECT_LT(second.y(), -10.0);
  }
}

// FIRST is launched when SECOND lies on it or has just not landed yet, and the owner of SECOND, who decides, does not
// know of that yet: the launch is not lost.
class LaunchUnknownToTheDecider : public testing::TestWithParam<double> {};
TEST_P(LaunchUnknownToTheDecider, Stands) {
  const double gap_m = GetParam();
  const ScratchFolder folder;
  folder.write("world.wrl", "#VRML V2.0 utf8\n" + mover("FIRST", "0 0 0", "Box { size 40 1 4 }") +
                                mover("SECOND", "0 " + std::to_string(1.0 + gap_m) + " 0", kBox) +
                                meet("FIRST", "SECOND"));
  const std::string text =
      "world = \"world.wrl\"\nduration_s = 4\n[replication]\nerror_threshold_m = 0.01\n[network]\nlatency_ms = 100\n"
      "[peer.one]\nid = 3\nowns = [\"FIRST\"]\n[peer.two]\nid = 1\nowns = [\"SECOND\"]\n"
      "[motion.FIRST]\nphysics = { velocity = [-1, 0, 0] }\n[motion.SECOND]\nphysics = { acceleration = [0, -1, 0] }\n";
  const Ran ran = std::move(run_scenario(folder.write("s.toml", text)).front());
  const auto first = std::ranges::find(ran.record.objects, "FIRST", &measure::ObjectInfo::path)->object;
  double x_m = 0.0, at_s = 0.0;
  for (const measure::GhostSample& sample : ran.record.ghost_samples) {
    if (sample.object == first && sample.t_s >= at_s) x_m = sample.truth.position.x(), at_s = sample.t_s;
  }
  EXPECT_GE(at_s, 3.9);
  EXPECT_NEAR(x_m, -at_s, 0.02);
}
INSTANTIATE_TEST_SUITE_P(Gaps, LaunchUnknownToTheDecider, testing::Values(0.0, 0.001, 0.004));

const Scene kScenes[] = {kRests, kPushes, kPresses, kPressesLater, kDriveChanges, kSupportIsRemoved, kSupportDrivesOff};

std::vector<Variation> variations() {
  std::vector<Variation> all;
  for (const Scene& scene : kScenes) {
    for (const char* const policy : {"id", "velocity", "expected-error", "field-of-view", "server"}) {
      for (const bool first_is_lower : {true, false}) {
        for (const double latency_ms : {0.0, 50.0, 200.0, 300.0}) {
          for (const char* const approach : {"dr", "dr+rcp+acpt"}) {
            all.push_back({scene, policy, first_is_lower, latency_ms, approach});
          }
        }
      }
    }
  }
  return all;
}

std::vector<Variation> hard_variations() {
  std::vector<Variation> all;
  for (const Scene& scene : kScenes) {
    for (const char* const policy : {"id", "velocity"}) {
      for (const bool first_is_lower : {true, false}) {
        for (const char* const approach : {"dr", "dr+rcp", "dr+rcp+acpt"}) {
          for (const char* const hz : {"20", "144"}) {
            all.push_back(
                {scene, policy, first_is_lower, 50.0, approach, {"replication.tick_hz=" + std::string(hz)}, hz});
          }
          // Of two updates that come in one tick the decider takes the later one to know the blow, whoever decides it.
          if (std::string_view(scene.name) == "PressesLater") continue;
          for (const char* const seed : {"1", "2", "3"}) {
            const std::vector<std::string> sets = {"network.loss=0.1", "network.jitter_ms=20",
                                                   "seed=" + std::string(seed)};
            all.push_back({scene, policy, first_is_lower, 50.0, approach, sets, "lossy"});
          }
        }
      }
    }
  }
  return all;
}

std::string name_of(const testing::TestParamInfo<Variation>& c) {
  const Variation& v = c.param;
  std::string name = std::string(v.scene.name) + '_' + v.policy + (v.first_is_lower ? "_12_" : "_21_") +
                     std::to_string(static_cast<int>(v.latency_ms)) + '_' + v.approach + '_' + v.how;
  if (!v.sets.empty()) name += '_' + v.sets.back();
  std::erase_if(name, [](char each) { return each != '_' && std::isalnum(static_cast<unsigned char>(each)) == 0; });
  return name;
}

INSTANTIATE_TEST_SUITE_P(OfTwoOwners, LastingContacts, testing::ValuesIn(variations()), name_of);
INSTANTIATE_TEST_SUITE_P(OnHardNetworks, LastingContacts, testing::ValuesIn(hard_variations()), name_of);

}  // namespace peerd::sim::lasting_contacts_test
