// What rests stays where it is, and costs nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "tests/replication/peer/worlds.hpp"
#include "tests/stress/resting_place.hpp"

namespace peerd::stress::resting_test {

using namespace replication;
using namespace replication::test;

// What is wrong at a place after that time; empty if nothing is.
std::string faults(const RestingPlace& place, Duration after) {
  const World world(place.world);
  MotionWorld motions(*world.model, sim(0s));
  for (const PlacedObject& support : place.supports)
    motions.set_base(world[support.name.c_str()], sim(0s), support.state);
  std::vector<ObjectId> bodies;
  for (const PlacedObject& body : place.bodies) {
    bodies.push_back(world[body.name.c_str()]);
    motions.declare(bodies.back(), Role::kAuthoritative);
    motions.set_free_acceleration(bodies.back(), body.state.acceleration);
    motions.set_base(bodies.back(), sim(0s), body.state);
  }
  std::ostringstream wrong;
  const double ulp = std::nextafter(place.coordinate_m, std::numeric_limits<double>::infinity()) - place.coordinate_m;
  const double most = place.gap_m + 1e-6 * place.size_m + 4.0 * ulp;
  const auto check = [&](Duration t) {
    for (std::size_t i = 0; i < place.bodies.size(); ++i) {
      const KinematicState now = motions.at(bodies[i], sim(t));
      const double moved = (now.position - place.bodies[i].state.position).norm();
      if (!(moved <= most)) wrong << place.bodies[i].name << " moved by " << moved << " m, not " << most << "; ";
      if (motions.is_at_rest_from(bodies[i], sim(t))) continue;
      wrong << place.bodies[i].name << " is not at rest: " << now.velocity.transpose() << " m/s, "
            << now.acceleration.transpose() << " m/s^2; ";
    }
    if (!wrong.str().empty()) wrong << "at " << to_seconds(t) << " s; ";
  };
  motions.advance(sim(10s));
  check(10s);
  if (!wrong.str().empty()) after = 10s;
  const MotionWorld::Counters before = motions.counters();
  motions.advance(sim(after));
  check(after);
  const MotionWorld::Counters& now = motions.counters();
  if (now.contact_searches != before.contact_searches || now.searches_far != before.searches_far) {
    wrong << now.contact_searches - before.contact_searches << " searches at rest; ";
  }
  if (!wrong.str().empty()) {
    wrong << now.contacts << " contacts, " << now.came_to_rest << " came to rest, " << now.jammed << " jammed, "
          << now.overlapped << " overlapped, " << now.failed << " failed, " << now.capped << " capped";
  }
  return wrong.str();
}

void check_places(std::uint64_t from, std::uint64_t count) {
  std::uint64_t bad = 0;
  for (std::uint64_t seed = from; seed < from + count; ++seed) {
    const RestingPlace place = make_resting_place(seed);
    const std::string wrong = faults(place, 3600s);
    if (wrong.empty()) continue;
    ++bad;
    ADD_FAILURE() << "seed " << seed << ", " << place.what << ": " << wrong;
  }
  if (bad > 0) std::cout << bad << " of " << count << " places\n";
}

TEST(Resting, StaysAtThreeThousandPlaces) { check_places(1, 3000); }

// PEERD_RESTS places from seed PEERD_RESTS_FROM on.
TEST(Resting, StaysAtAsManyPlacesAsAreAskedFor) {
  const char* const count = std::getenv("PEERD_RESTS");
  if (count == nullptr) GTEST_SKIP() << "PEERD_RESTS is not set";
  const char* const from = std::getenv("PEERD_RESTS_FROM");
  check_places(from != nullptr ? std::stoull(from) : 1, std::stoull(count));
}

}  // namespace peerd::stress::resting_test
