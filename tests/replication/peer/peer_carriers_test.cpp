// A car and its wheel, of two owners: what is carried goes with its carrier on every peer, at no cost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::peer_carriers_test {

using namespace test;
using testing::IsEmpty;

const Vec3 kWheelInCar(1, -1, 0);

// The front of the wheel is 1.5 m before the middle of the car. The curb's front is at 5 m.
std::string car_and_curb() {
  return car_and_wheel("-20 2 0") + box("CURB", "0.5 0.6 40", "5.25 0.5 0") + interest("WHEEL", "\"CURB\"");
}

// The car drives at 3 m/s along x and sways, so that its ghost is corrected again and again.
KinematicState swaying(SimTime t) {
  const double s = to_seconds(t.time_since_epoch() - kEpoch);
  return moving({-20 + 3 * s, 2, 2 * std::sin(2 * s)}, {3, 0, 4 * std::cos(2 * s)}, {0, 0, -8 * std::sin(2 * s)});
}
// The wheel's front is at the curb when the car is at 3.5 m.
constexpr double kAtCurb_s = 23.5 / 3.0;

class CarAndWheel : public testing::Test {
 protected:
  // Peer 1 drives the car, peer 2 owns the wheel, and peer 3 watches.
  void add_three() {
    lan.add(config(1, {{world["CAR"], true}}), 0s, {{world["CAR"], swaying}});
    lan.add(config(2, {{world["WHEEL"], false}}), 7s);
    lan.add(config(3), 3s);
  }
  [[nodiscard]] std::size_t published(std::size_t i, const char* object, PublishReason reason, Duration since) const {
    std::size_t count = 0;
    for (const Published& p : lan.seen<Published>(i)) {
      count += p.at >= SimTime{kEpoch + since} && p.object == world[object] && p.reason == reason;
    }
    return count;
  }

  World world{car_and_curb(), {"CAR", "WHEEL"}};
  Lan lan{world, {.latency = 40ms}};
};

TEST_F(CarAndWheel, TheWheelGoesWithTheCarOnEveryPeer) {
  add_three();
  lan.run_until(4s);
  for (int k = 0; k < 40; ++k) {
    lan.run_until(lan.now() + 97ms);
    const SimTime t = lan.session_now(0) - 100ms;
    for (std::size_t i = 0; i < 3; ++i) {
      const KinematicState car = lan.peer(i).ghost(world["CAR"], t), wheel = lan.peer(i).ghost(world["WHEEL"], t);
      EXPECT_LT((wheel.position - car.pose() * kWheelInCar).norm(), 1e-3) << "as its owner has published it";
      EXPECT_LT((wheel.velocity - car.velocity).norm(), 1e-3);
      EXPECT_TRUE(same_bits(wheel, lan.peer(0).ghost(world["WHEEL"], t))) << "everywhere";
    }
  }
}

TEST_F(CarAndWheel, ACorrectionOfTheCarCostsTheWheelNoUpdate) {
  add_three();
  lan.run_until(4s);
  const std::uint64_t before = lan.peer(1).counters().updates_out;
  lan.run_until(14s);
  EXPECT_GT(published(0, "CAR", PublishReason::kError, 4s), 5u);
  EXPECT_LE(lan.peer(1).counters().updates_out, before + 2) << "one in 5 s, however the car goes";
  EXPECT_EQ(published(1, "WHEEL", PublishReason::kError, 4s), 0u);
}

// Cells of 10 m along x: region 1 is [0, 10), 2 is [10, 20), .. 8 is [-10, 0). By its place in the car, the wheel would
// always be in region 1.
TEST_F(CarAndWheel, TheWheelIsPublishedInTheRegionWhereItIsInTheWorld) {
  RegionSettings cut;
  cut.cell_m = 10.0;
  cut.regions = {8, 1, 1};
  cut.hysteresis = {0.5, 500ms};
  cut.fastest_m_s = 15.0;
  const auto drives = [](SimTime t) {
    return moving({-25 + 10 * (to_seconds(t.time_since_epoch() - kEpoch) - 3.0), 2, 0}, {10, 0, 0});
  };
  std::vector<std::uint32_t> regions;
  lan.on_send = [&](std::size_t, RegionId region, const Message& m) {
    for (const UpdateRecord& u : m.updates) {
      if (lan.now() < 3s || u.object != world["WHEEL"]) continue;
      if (regions.empty() || regions.back() != region.value) regions.push_back(region.value);
      EXPECT_LT((u.model.state.position - kWheelInCar).norm(), 1e-3) << "relative to the car";
    }
  };
  PeerConfig car = config(1, {{world["CAR"], true}}), wheel = config(2, {{world["WHEEL"], false}}), sees = config(3);
  for (PeerConfig* c : {&car, &wheel, &sees}) c->regions = cut;
  lan.add(car, 0s, {{world["CAR"], drives}});
  lan.add(wheel);
  lan.add(sees);
  lan.run_until(7s);
  EXPECT_EQ(regions, (std::vector<std::uint32_t>{7, 8, 1, 2})) << "from -24 to 16 m";
  const SimTime t = lan.session_now(0) - 100ms;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((lan.peer(i).ghost(world["WHEEL"], t).position - (drives(t).position + kWheelInCar)).norm(), 0.01) << i;
  }
}

// The car's owner leaves: car and wheel stand, and the wheel is still its owner's.
TEST_F(CarAndWheel, TheWheelStandsWithTheCarOfAPeerThatLeft) {
  add_three();
  lan.run_until(4s);
  lan.leave(0);
  lan.run_until(5s);
  const SimTime t = lan.session_now(1);
  for (const std::size_t i : {1u, 2u}) {
    const KinematicState car = lan.peer(i).ghost(world["CAR"], t), wheel = lan.peer(i).ghost(world["WHEEL"], t);
    EXPECT_EQ(car.velocity, Vec3(Vec3::Zero()));
    EXPECT_EQ(wheel.velocity, Vec3(Vec3::Zero()));
    EXPECT_LT((wheel.position - car.pose() * kWheelInCar).norm(), 1e-3);
    EXPECT_EQ(lan.peer(i).owner(world["WHEEL"]), PeerId{2});
  }
}

// The car brakes 0.3 m before the curb. A latency later than that, the other peer has seen the wheel at the curb.
TEST_F(CarAndWheel, AContactOfNobodysWheelIsRetractedWithTheCar) {
  Lan far(world, {.latency = 300ms});
  const auto brakes = [](SimTime t) {
    const double s = to_seconds(t.time_since_epoch() - kEpoch), at_s = kAtCurb_s - 0.1;
    return moving({-20 + 3 * std::min(s, at_s), 2, 0}, {s < at_s ? 3.0 : 0.0, 0, 0});
  };
  PeerConfig car = config(1, {{world["CAR"], true}});
  car.policy.error_threshold_m = 0.01;
  far.add(car, 0s, {{world["CAR"], brakes}});
  far.add(config(2), 7s);
  far.run_until(12s);
  EXPECT_THAT(standing_contacts(far, 0), IsEmpty());
  EXPECT_FALSE(far.contacts(1, ContactKind::kScene).empty()) << "as it seemed at first";
  EXPECT_THAT(standing_contacts(far, 1), IsEmpty());
}

// A door slides in a bus that sways; each update of the bus is of an instant before what the door has met meanwhile.
TEST(BusAndDoor, ACorrectionOfTheBusLeavesWhatItsDoorHasMetInIt) {
  const World world("DEF BUS Transform { translation -20 2 0 children [ " +
                        box("DOOR", "1 2 0.1", "0 1 1.5", "velocityVector 0.25 0 0") +
                        box("POST", "0.1 2 0.1", "2 1 1.5") + "] }\n" + interest("DOOR", "\"POST\""),
                    {"BUS", "BUS/DOOR"});
  Lan lan(world, {.latency = 200ms});
  PeerConfig bus = config(1, {{world["BUS"], true}});
  bus.policy.error_threshold_m = 0.01;
  lan.add(bus, 0s, {{world["BUS"], swaying}});
  lan.add(config(2, {{world["DOOR"], false}}));
  lan.add(config(3));
  lan.run_until(9s);
  for (const std::size_t i : {0u, 1u, 2u}) EXPECT_EQ(standing_contacts(lan, i).size(), 1u) << i;
}

// Each peer has been told of its own objects only.
TEST(DifferentOwnersKnown, TheWheelIsWhereItIsAllTheSame) {
  const World of_car(car_and_curb(), {"CAR"}), of_wheel(car_and_curb(), {"WHEEL"});
  Lan lan(of_car, {.latency = 40ms});
  lan.add(config(1, {{of_car["CAR"], true}}), 0s, {{of_car["CAR"], swaying}});
  lan.add(config(2, {{of_car["WHEEL"], false}}), 7s, {}, &of_wheel);
  lan.run_until(6s);
  const SimTime t = lan.session_now(0) - 100ms;
  const Vec3 wheel = lan.peer(0).ghost(of_car["WHEEL"], t).position;
  EXPECT_LT((wheel - swaying(t).pose() * kWheelInCar).norm(), 0.6);
  EXPECT_LT((lan.peer(1).ghost(of_car["WHEEL"], t).position - wheel).norm(), 1e-3);
}

}  // namespace peerd::replication::peer_carriers_test
