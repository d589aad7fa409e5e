#include "tests/sim/living/run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>

#include "collision/scene/collision_watch.hpp"
#include "core/motion/scene_motion.hpp"
#include "core/scene/reader.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::living {
namespace {

using sim::testing_support::must;

// The interests in file order are those of the world, so no path has to be resolved to know which is which.
std::vector<Pair> pairs_of(const World& world, std::span<const collision::WatchedInterest> watched) {
  std::vector<Pair> pairs;
  for (const Interest& interest : world.interests) {
    for (const int collidee : interest.collidees) {
      const auto& object = watched[pairs.size()];
      pairs.push_back({interest.collider, collidee, interest.type, object.collider, object.collidee});
    }
  }
  if (pairs.size() != watched.size()) throw std::runtime_error("the scene has other interests than the world");
  return pairs;
}

// A row says its type, or it does not yet.
template <class Row>
bool is_of_type(const Row& row, InterestType type) {
  if constexpr (requires { row.type; }) {
    return static_cast<int>(row.type) == static_cast<int>(type);
  } else {
    return true;
  }
}

const char* name_of(InterestType type) {
  return type == InterestType::kBox ? "box" : type == InterestType::kWitness ? "witness" : "allpairs";
}

}  // namespace

Reference reference_of(const World& world) {
  Reference reference;
  const std::string text = vrml_of(world);
  const ReadResult read = read_world(text);
  for (const Diagnostic& problem : read.diagnostics) reference.problems.push_back(problem.message);
  if (!read.scene) return reference;
  collision::CollisionWatch watch(*read.scene);
  SceneMotion motion(*read.scene);
  reference.pairs = pairs_of(world, watch.interests());
  std::map<std::uint32_t, std::size_t> open;  // by pair, into contacts
  for (int k = 0; k / kReference_hz <= world.duration_s; ++k) {
    const double time_s = k / kReference_hz;
    watch.set_transforms(motion.transforms_at(time_s));
    for (auto& moved : motion.moved_geometries(time_s)) watch.reshape(moved.index, std::move(moved.form));
    const auto& tick = watch.tick();
    for (const auto& refused : tick.refused) reference.problems.push_back(refused.why);
    for (const std::uint32_t pair : tick.ended) {
      reference.contacts[open.at(pair)].ended_s = time_s;
      open.erase(pair);
    }
    for (const std::uint32_t pair : tick.began) {
      open.emplace(pair, reference.contacts.size());
      reference.contacts.push_back({pair, time_s, std::numeric_limits<double>::infinity()});
    }
  }
  return reference;
}

report::RunRecord run_peers(const World& world, const testing_support::ScratchFolder& folder) {
  folder.write("living.wrl", vrml_of(world));
  const auto file = folder.write("living.toml", scenario_of(world));
  const config::Scenario scenario = must(config::read_scenario({.file = file, .configs = {}, .sets = {}, .seed = {}}));
  const auto shared = must(share_world(scenario.world));
  const auto logs = must(sim::simulate(scenario.runs[0], *shared));
  return must(assemble(scenario.runs[0], *shared, logs));
}

bool must_be_found(const World& world, const Contact& contact) {
  constexpr double kHalfTick_s = 0.5 / kReference_hz;  // times of ticks are rounded
  return contact.ended_s - contact.began_s >= 0.002 - kHalfTick_s && contact.began_s > 1e-3 * world.latency_ms + 0.01 &&
         contact.began_s < world.duration_s - 0.1;
}

std::vector<std::size_t> pairs_of(const Reference& reference, const report::ContactRow& row) {
  std::vector<std::size_t> found;
  for (std::size_t p = 0; p < reference.pairs.size(); ++p) {
    const Pair& pair = reference.pairs[p];
    const bool same = row.collider == pair.collider_object && row.collidee == pair.collidee_object;
    const bool turned = row.collider == pair.collidee_object && row.collidee == pair.collider_object;
    if ((same || turned) && is_of_type(row, pair.type)) found.push_back(p);
  }
  return found;
}

Comparison compare(const World& world, const Reference& reference, const report::RunRecord& record) {
  Comparison comparison;
  std::map<PeerId, std::vector<std::vector<double>>> times_s;  // by peer and pair
  for (std::size_t p = 0; p < world.peers.size(); ++p) {
    times_s[PeerId{std::uint32_t(p + 1)}].resize(reference.pairs.size());
  }
  for (const report::ContactRow& row : record.contacts) {
    const auto pairs = pairs_of(reference, row);
    bool expected = false;
    for (const std::size_t pair : pairs) {
      times_s.at(row.peer)[pair].push_back(row.t_s);
      expected = expected || std::ranges::any_of(reference.contacts, [&](const Contact& contact) {
                   return contact.pair == pair && std::abs(contact.began_s - row.t_s) <= kAgreed_s;
                 });
    }
    if (!expected) comparison.besides.push_back(row);
  }
  for (const Contact& contact : reference.contacts) {
    if (!must_be_found(world, contact)) continue;
    for (const auto& [peer, by_pair] : times_s) {
      ++comparison.compared;
      std::optional<double> nearest_s;
      for (const double t_s : by_pair[contact.pair]) {
        const bool nearer = !nearest_s || std::abs(t_s - contact.began_s) < std::abs(*nearest_s - contact.began_s);
        if (nearer) nearest_s = t_s;
      }
      const bool found = nearest_s && std::abs(*nearest_s - contact.began_s) <= kAgreed_s;
      if (!found) comparison.missing.push_back({contact, peer, nearest_s});
    }
  }
  return comparison;
}

std::string text_of(const World& world, const Reference& reference, const Missing& missing) {
  const Pair& pair = reference.pairs[missing.contact.pair];
  std::ostringstream text;
  text.precision(9);
  text << "peer " << world.peers[missing.peer.value - 1] << ": " << path_of(world, pair.collider) << " - "
       << path_of(world, pair.collidee) << " (" << name_of(pair.type) << ") from " << missing.contact.began_s << " to "
       << missing.contact.ended_s << " s; nearest row: ";
  if (missing.nearest_s) {
    text << *missing.nearest_s << " s";
  } else {
    text << "none";
  }
  return text.str();
}

}  // namespace peerd::living
