#include "replication/objects/replica/own_objects.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::own_objects_test {

using namespace test;

class Owned : public testing::Test {
 protected:
  std::vector<ObjectId> checked(SimTime t) const {
    std::vector<ObjectId> due;
    for (std::size_t i = own.next_to_check(0, t); i != own.size(); i = own.next_to_check(i + 1, t)) {
      due.push_back(own.map().nth(i)->first);
    }
    return due;
  }
  void check_all_from(SimTime t) {
    for (std::size_t i = 0; i < own.size(); ++i) own.check_from(i, t);
  }

  World world{box("A", "2 2 2", "0 0 0") + box("B", "1 1 1", "5 0 0") + box("C", "1 1 1", "9 0 0") +
              box("D", "1 1 1", "12 0 0")};
  ObjectId a = world["A"], b = world["B"], c = world["C"], d = world["D"];
  std::vector<OwnedObject> objects{{c, false, {2s, Vec3(1, 0, 0)}}, {a, true}, {b, false}};
  OwnObjects own{*world.in_force, objects, false};
};

TEST_F(Owned, AreThoseOfTheConfigurationInOrder) {
  std::vector<ObjectId> ids;
  for (const auto& [object, each] : own) ids.push_back(object);
  EXPECT_EQ(ids, (std::vector<ObjectId>{a, b, c}));
  EXPECT_TRUE(own.contains(a) && own.find(b) != nullptr);
  EXPECT_TRUE(!own.contains(d) && own.find(d) == nullptr);
  EXPECT_TRUE(own.at(a).driven);
  EXPECT_FALSE(own.at(c).driven);
  EXPECT_EQ(own.at(c).launch.after, 2s);
  EXPECT_EQ(own.at(c).launch.velocity, Vec3(1, 0, 0));
  EXPECT_EQ(own.at(a).bounding_radius_m, 0.0) << "errors count by the origin";
}

TEST_F(Owned, ASceneObjectIsOneOfThemForAWhile) {
  own.adopt(d);
  EXPECT_TRUE(own.at(d).adopted && !own.at(d).driven);
  EXPECT_EQ(own.at(d).sequence, 0u);
  EXPECT_FALSE(own.at(b).adopted);
  own.republish(d);
  EXPECT_TRUE(own.at(d).republish);
  own.at(d).sequence = 7;
  own.remove({&d, 1});
  EXPECT_FALSE(own.contains(d));
  own.adopt(d);
  EXPECT_EQ(own.at(d).sequence, 7u) << "what it published before is older";
}

TEST_F(Owned, SurfaceErrorsCountByTheFarthestVertex) {
  const OwnObjects by_surface(*world.in_force, objects, true);
  EXPECT_NEAR(by_surface.at(a).bounding_radius_m, std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(by_surface.at(b).bounding_radius_m, std::sqrt(0.75), 1e-12);
}

TEST_F(Owned, AreCheckedAtFirstAndThenFromWhenTheySay) {
  EXPECT_EQ(checked(sim(0s)), (std::vector<ObjectId>{a, b, c}));
  own.check_from(0, sim(1s));
  own.check_from(2, sim(2s));
  EXPECT_EQ(checked(sim(1s) - 1ns), (std::vector<ObjectId>{b}));
  EXPECT_EQ(checked(sim(1s)), (std::vector<ObjectId>{a, b}));
  EXPECT_EQ(checked(sim(2s)), (std::vector<ObjectId>{a, b, c}));
}

TEST_F(Owned, OneOrAllAreCheckedOnDemand) {
  check_all_from(SimTime::max());
  EXPECT_TRUE(checked(sim(9s)).empty());
  own.check(b);
  own.check(d);  // another's
  EXPECT_EQ(checked(sim(0s)), (std::vector<ObjectId>{b}));
  own.check_all();
  EXPECT_EQ(checked(sim(0s)), (std::vector<ObjectId>{a, b, c}));
}

TEST_F(Owned, RepublishingAndResendingAskForAnUpdateAndACheck) {
  check_all_from(SimTime::max());
  own.republish(c);
  own.republish(d);
  EXPECT_EQ(checked(sim(0s)), (std::vector<ObjectId>{c}));
  EXPECT_TRUE(own.at(c).republish && !own.at(b).republish);
  own.resend_all();
  EXPECT_EQ(checked(sim(0s)), (std::vector<ObjectId>{a, b, c}));
  for (const auto& [object, each] : own) EXPECT_TRUE(each.resend);
}

TEST_F(Owned, WhatIsRemovedIsNoLongerCheckedAndTheOthersKeepWhatTheyHave) {
  own.at(c).sequence = 7;
  check_all_from(SimTime::max());
  own.remove(std::vector{b, d});
  EXPECT_FALSE(own.contains(b));
  EXPECT_EQ(own.size(), 2u);
  EXPECT_EQ(own.at(c).sequence, 7u);
  EXPECT_EQ(checked(sim(0s)), (std::vector<ObjectId>{a, c})) << "their indices are others now";
  check_all_from(SimTime::max());
  own.check(b);
  EXPECT_TRUE(checked(sim(0s)).empty());
  own.check(c);
  EXPECT_EQ(checked(sim(0s)), (std::vector<ObjectId>{c}));
}

TEST_F(Owned, APeerThatHasGoneHasAcknowledgedNothing) {
  for (const std::uint32_t peer : {2u, 3u}) {
    own.at(a).delivery.acknowledged_by.insert(PeerId{peer});
    own.at(b).delivery.unacknowledged_by.insert(PeerId{peer});
  }
  own.forget_acknowledgements_of(PeerId{2});
  EXPECT_FALSE(own.at(a).delivery.acknowledged_by.contains(PeerId{2}));
  EXPECT_FALSE(own.at(b).delivery.unacknowledged_by.contains(PeerId{2}));
  EXPECT_TRUE(own.at(a).delivery.acknowledged_by.contains(PeerId{3}));
  EXPECT_TRUE(own.at(b).delivery.unacknowledged_by.contains(PeerId{3}));
}

}  // namespace peerd::replication::own_objects_test
