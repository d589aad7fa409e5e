#include "tests/sim/living/run.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
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

const char* name_of(InterestType type) { return peerd::name_of(static_cast<CollisionType>(type)); }

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

void write_texts(const World& world, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "living.wrl") << vrml_of(world);
  std::ofstream(folder / "living.toml") << scenario_of(world);
}

measure::RunRecord run_peers(const World& world, const std::filesystem::path& folder) {
  write_texts(world, folder);
  const auto file = folder / "living.toml";
  const config::Scenario scenario = sim::testing_support::scenario_of(file);
  const auto shared = must(share_world(scenario.world));
  const auto logs = must(sim::simulate(scenario.runs[0], *shared));
  return must(assemble(scenario.runs[0], *shared, logs));
}

double known_from_s(const World& world) { return 1e-3 * world.latency_ms + 0.01; }

bool must_be_found(const World& world, const Contact& contact) {
  constexpr double kHalfTick_s = 0.5 / kReference_hz;  // times of ticks are rounded
  return contact.ended_s - contact.began_s >= 0.002 - kHalfTick_s && contact.began_s > 1e-3 * world.latency_ms + 0.01 &&
         contact.began_s < world.duration_s - 0.1;
}

std::vector<std::size_t> pairs_of(const Reference& reference, const measure::ContactRow& row) {
  std::vector<std::size_t> found;
  for (std::size_t p = 0; p < reference.pairs.size(); ++p) {
    const Pair& pair = reference.pairs[p];
    const bool same = row.collider == pair.collider_object && row.collidee == pair.collidee_object;
    const bool turned = row.collider == pair.collidee_object && row.collidee == pair.collider_object;
    if ((same || turned) && row.type == static_cast<CollisionType>(pair.type)) found.push_back(p);
  }
  return found;
}

Comparison compare(const World& world, const Reference& reference, const measure::RunRecord& record) {
  Comparison comparison;
  std::map<PeerId, std::vector<std::vector<double>>> times_s;  // by peer and pair
  for (std::size_t p = 0; p < world.peers.size(); ++p) {
    times_s[PeerId{std::uint32_t(p + 1)}].resize(reference.pairs.size());
  }
  for (const measure::ContactRow& row : record.contacts) {
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

namespace {

bool is_below(const World& world, int node, int above) {
  for (int i = world.nodes[std::size_t(node)].parent; i >= 0; i = world.nodes[std::size_t(i)].parent) {
    if (i == above) return true;
  }
  return false;
}

// Whether what others than that peer own moves one of the two.
bool depends_on_others(const World& world, const Pair& pair, PeerId peer) {
  for (int i = 0; i < int(world.nodes.size()); ++i) {
    const int owner = world.nodes[std::size_t(i)].owner;
    if (owner < 0 || PeerId{std::uint32_t(owner + 1)} == peer) continue;
    for (const int end : {pair.collider, pair.collidee}) {
      if (i == end || is_below(world, i, end) || is_below(world, end, i)) return true;
    }
  }
  return false;
}

class Judge {
 public:
  Judge(const World& world, const Reference& reference)
      : world_(world), reference_(reference), motion_(world), oracles_(reference.pairs.size()) {}

  // None where the row is not to be judged.
  std::optional<ContactOracle::Verdict> verdict(const measure::ContactRow& row, std::size_t pair) {
    const double known_s = known_from_s(world_);
    const Pair& ends = reference_.pairs[pair];
    if (row.reported_at_s < known_s && depends_on_others(world_, ends, row.peer)) return std::nullopt;
    double since_s = 0.0;
    for (const Contact& contact : reference_.contacts) {
      if (contact.pair != pair) continue;
      const bool covers = contact.began_s <= row.t_s + 1.0 / kReference_hz && row.t_s <= contact.ended_s;
      if (covers && contact.began_s <= known_s) return std::nullopt;
      if (contact.ended_s <= row.t_s) since_s = std::max(since_s, contact.ended_s);
    }
    auto& oracle = oracles_[pair];
    if (!oracle) oracle.emplace(motion_, world_, ends.collider, ends.collidee, ends.type);
    return oracle->judge(since_s, row.t_s);
  }

 private:
  const World& world_;
  const Reference& reference_;
  OracleMotion motion_;
  std::vector<std::optional<ContactOracle>> oracles_;  // by pair
};

}  // namespace

Judgement judge(const World& world, const Reference& reference, const std::vector<measure::ContactRow>& rows) {
  Judge oracle(world, reference);
  Judgement out;
  for (const measure::ContactRow& row : rows) {
    std::optional<Fault> fault;
    bool good = false, judged = false;
    for (const std::size_t pair : pairs_of(reference, row)) {
      const auto verdict = oracle.verdict(row, pair);
      good = good || !verdict || (!verdict->is_early() && !verdict->is_late());
      judged = judged || verdict;
      if (!verdict) continue;
      out.unproven_s += verdict->unproven_s;
      out.incomplete += !verdict->complete;
      if (!fault || verdict->distance_m.lo < fault->verdict.distance_m.lo) fault = Fault{row, pair, *verdict};
    }
    out.judged += judged;
    if (!good && fault) out.faults.push_back(*fault);
  }
  return out;
}

namespace {

std::string name_of(const World& world, const Reference& reference, PeerId peer, std::size_t pair) {
  const Pair& ends = reference.pairs[pair];
  return "peer " + world.peers[peer.value - 1] + ": " + path_of(world, ends.collider) + " - " +
         path_of(world, ends.collidee) + " (" + name_of(ends.type) + ")";
}

}  // namespace

std::string text_of(const World& world, const Reference& reference, const Missing& missing) {
  std::ostringstream text;
  text.precision(9);
  text << name_of(world, reference, missing.peer, missing.contact.pair) << " from " << missing.contact.began_s << " to "
       << missing.contact.ended_s << " s; nearest row: ";
  if (missing.nearest_s) {
    text << *missing.nearest_s << " s";
  } else {
    text << "none";
  }
  return text.str();
}

std::string text_of(const World& world, const Reference& reference, const Fault& fault) {
  std::ostringstream text;
  text.precision(12);
  text << name_of(world, reference, fault.row.peer, fault.pair) << ' ' << fault.row.kind << " at " << fault.row.t_s
       << " s: the distance then is " << fault.verdict.distance_m.lo << " to " << fault.verdict.distance_m.hi << " m";
  if (fault.verdict.is_late()) text << "; they touch for " << fault.verdict.late_s << " s already";
  return text.str();
}

}  // namespace peerd::living
