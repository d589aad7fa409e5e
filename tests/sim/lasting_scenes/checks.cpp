// Runs a scene, and checks what must hold of it.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "tests/sim/lasting_scenes/overlap.hpp"
#include "tests/sim/lasting_scenes/scene.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::lasting_scenes {
namespace {

constexpr double kSame_m = 1e-6;         // of ends, and of ghosts
constexpr double kRounding_m = 1e-9;     // of a depth
constexpr double kContactTime_s = 2e-9;  // contact times are whole nanoseconds
constexpr double kRounding = 1e-9;       // of momentum, and of the energy of a contact
constexpr double kEnergyOfRun = 1e-6;

using Nanos = std::int64_t;                            // since the motions began
using States = std::map<std::size_t, KinematicState>;  // by body

// A contact that an owner has answered, or decided.
struct Answered {
  Nanos at;
  std::size_t collider, collidee;  // bodies
  replication::ContactEvent event;
};
struct Run {
  std::map<Nanos, States> truths;                          // what the owners say at their ticks
  std::map<std::pair<std::string, Nanos>, States> ghosts;  // what each other peer shows
  std::map<std::string, std::uint64_t> counters;
  std::vector<Answered> answered;
  std::vector<double> decided_s;
  std::string differing;  // what peers have shown elsewhere than its owner
};

Run run_of(const LastingScene& scene, const std::string& folder, bool one_owner) {
  const auto put = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder + "/" + name, std::ios::binary) << text;
  };
  const std::string name = one_owner ? "one-owner.toml" : "scene.toml";
  put("world.wrl", scene.world());
  put(name, scene.scenario(one_owner));
  const config::Scenario scenario = testing_support::scenario_of(folder + "/" + name);
  const auto shared = must(share_world(scenario.world, scenario.reading, scenario.runs));
  Run run;
  std::vector<replication::ContactSeen> seen;
  std::vector<replication::GhostDiffers> different;
  const auto logs =
      must(simulate(scenario.runs[0], *shared, [&](HostTime, const PeerNode&, const replication::Output& o) {
        const auto* contact = std::get_if<replication::ContactSeen>(&o);
        if (const auto* differs = std::get_if<replication::GhostDiffers>(&o);
            differs != nullptr && !differs->explained) {
          different.push_back(*differs);
        }
        using replication::ContactKind;
        if (contact != nullptr && (contact->kind == ContactKind::kOwner || contact->kind == ContactKind::kDecided)) {
          seen.push_back(*contact);
        }
      }));
  std::map<ObjectId, std::size_t> bodies;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    bodies[*shared->model->scene->find(scene.bodies[b].name)] = b;
  }
  std::optional<SimTime> start;
  for (const PeerLog& log : logs) {
    for (const auto& [counter, value] : log.counters) run.counters[counter] += value;
    if (!log.start) continue;
    start = log.start;
    for (const PeerLog::ObjectSample& s : log.object_samples) {
      const Nanos t = (s.at - *log.start).count();
      const auto body = bodies.find(s.object);
      if (t < 0 || body == bodies.end()) continue;
      (s.owner == log.peer ? run.truths[t] : run.ghosts[{log.name, t}])[body->second] = s.state;
    }
  }
  std::ostringstream text;
  for (const replication::GhostDiffers& each : different) {
    text << ", " << scene.bodies[bodies.at(each.object)].name << " of " << each.owner.value << " by " << each.by.value
         << " at " << to_seconds(each.at - *start) << " s by " << each.distance_m << " m";
  }
  run.differing = text.str();
  for (const auto& contact : seen) {
    if (contact.kind == replication::ContactKind::kDecided) {
      run.decided_s.push_back(to_seconds(contact.contact.at - *start));
    }
    const auto& c = contact.contact;
    const auto a = bodies.find(c.collider), b = bodies.find(c.collidee);
    if (c.at < *start || c.deferred || a == bodies.end() || b == bodies.end()) continue;
    run.answered.push_back({(c.at - *start).count(), a->second, b->second, c});
  }
  return run;
}

// For who looks for a cause: time, who shows it, body, position, velocity, acceleration.
void write_states(const LastingScene& scene, const Run& run, const std::string& file) {
  std::ofstream out(file);
  out.precision(12);
  const auto put = [&](const std::string& by, Nanos t, const States& states) {
    for (const auto& [b, s] : states) {
      out << 1e-9 * double(t) << ' ' << by << ' ' << scene.bodies[b].name << ' ' << s.position.transpose() << ' '
          << s.velocity.transpose() << ' ' << s.acceleration.transpose() << '\n';
    }
  };
  for (const auto& [t, states] : run.truths) put("truth", t, states);
  for (const auto& [when, states] : run.ghosts) put(when.first, when.second, states);
  for (const Answered& c : run.answered) {
    out << 1e-9 * double(c.at) << " contact " << scene.bodies[c.collider].name << ' ' << scene.bodies[c.collidee].name
        << " normal " << c.event.normal.transpose() << (c.event.rests ? " rests" : "") << '\n';
  }
}

// The last state of a body at or before t, and when that was.
std::optional<std::pair<Nanos, KinematicState>> last_truth(const Run& run, std::size_t body, Nanos t) {
  for (auto at = run.truths.upper_bound(t); at != run.truths.begin();) {
    --at;
    const auto found = at->second.find(body);
    if (found != at->second.end()) return std::pair{at->first, found->second};
  }
  return std::nullopt;
}

class Checks {
 public:
  Checks(const LastingScene& scene, const std::string& folder, bool writes_states)
      : scene_(scene), one_(run_of(scene, folder, true)), run_(scene.owners > 1 ? run_of(scene, folder, false) : one_) {
    if (writes_states) {
      write_states(scene, one_, folder + "/one-owner.txt");
      write_states(scene, run_, folder + "/scene.txt");
    }
    way_s_ = 1e-3 * (scene.latency_ms + scene.jitter_ms);
    // What is lost is sent again once echoes or a hello say so, which may be lost, too.
    if (scene.loss > 0.0) way_s_ += 3.0 * (2.0 * way_s_ + 0.3);
    // To decide takes a tick, and so does to take it.
    window_s_ = 2.0 * way_s_ + 2.0 / scene.tick_hz;
  }

  std::vector<std::string> lines() {
    check_digests("one owner", one_);
    check_truth("one owner", one_, false);
    check_ghosts("one owner", one_);
    check_end("one owner", one_);
    check_rest(one_);
    check_energy(one_);
    check_momentum("one owner", one_);
    if (scene_.owners > 1) {
      check_digests("owners", run_);
      check_truth("owners", run_, true);
      check_ghosts("owners", run_);
      check_end("owners", run_);
      check_momentum("owners", run_);
      check_energy_at_rest(run_);
      if (scene_.is_unique) check_unique();
    }
    return std::move(lines_);
  }

 private:
  template <class... Parts>
  void add(const std::string& check, const Parts&... parts) {
    if (++counts_[check] > 3) return;
    std::ostringstream line;
    line.precision(10);
    line << check << ": ";
    (line << ... << parts);
    lines_.push_back(line.str());
  }
  static double seconds(Nanos t) { return 1e-9 * double(t); }
  const Body& body(std::size_t b) const { return scene_.bodies[b]; }
  bool is_there(std::size_t b, double t_s) const { return body(b).name != scene_.removed || t_s < scene_.removed_s; }

  void check_digests(const std::string& of, const Run& run) {
    const auto differ = run.counters.find("ghosts_differ");
    if (differ == run.counters.end() || differ->second != 0) {
      add(of + " digests", differ == run.counters.end() ? 0 : differ->second, " differ", run.differing);
    }
  }

  // Whether something that nobody could know before is on its way at t.
  bool is_surprised(const Run& run, double t_s) const {
    const auto within = [&](double begin_s, double end_s) { return begin_s <= t_s + 1e-9 && t_s <= end_s + window_s_; };
    if (scene_.is_driven() && within(0.0, scene_.driven_until_s)) return true;
    return std::ranges::any_of(scene_.inputs_s, [&](double at_s) { return within(at_s, at_s); }) ||
           std::ranges::any_of(run.decided_s, [&](double at_s) { return within(at_s, at_s); });
  }
  // By dead reckoning alone no contact is predicted: a ghost goes on through it until it is off by the threshold.
  bool ghosts_are_surprised(const Run& run, double t_s) const {
    return scene_.approach == "dr" || is_surprised(run, t_s);
  }
  double allowed_by_surprise_m(double fastest_m_s) const {
    const double threshold = scene_.approach == "dr+rcp+acpt" ? std::min(0.01, scene_.threshold_m) : scene_.threshold_m;
    return threshold + fastest_m_s * (way_s_ + 1.0 / scene_.tick_hz);
  }

  // Calls `take` with each pair of bodies that overlap at one instant, their depth [m] and relative speed [m/s]. Bodies
  // that nobody owns stand where they began.
  template <class Take>
  void each_pair(const States& states, double t_s, const Take& take) const {
    for (std::size_t a = 0; a < scene_.bodies.size(); ++a) {
      for (std::size_t b = a + 1; b < scene_.bodies.size(); ++b) {
        if (body(a).motion != Motion::kPhysics && body(b).motion != Motion::kPhysics) continue;
        if (!is_there(a, t_s) || !is_there(b, t_s)) continue;
        const auto state = [&](std::size_t which) -> std::optional<KinematicState> {
          const auto found = states.find(which);
          if (found != states.end()) return found->second;
          if (body(which).owner >= 0) return std::nullopt;
          KinematicState stands;
          stands.position = body(which).at;
          stands.orientation = body(which).pose().orientation;
          return stands;
        };
        const auto one = state(a), other = state(b);
        if (!one || !other) continue;
        take(a, b, overlap_m(body(a), one->pose(), body(b), other->pose()), (one->velocity - other->velocity).norm());
      }
    }
  }

  void check_truth(const std::string& of, const Run& run, bool several_owners) {
    std::map<std::pair<std::size_t, std::size_t>, std::map<Nanos, double>> speeds;
    for (const auto& [t, states] : run.truths) {
      each_pair(states, seconds(t), [&, t = t](std::size_t a, std::size_t b, double depth, double speed) {
        auto& recent = speeds[{a, b}];
        recent[t] = speed;
        while (seconds(t - recent.begin()->first) > window_s_) recent.erase(recent.begin());
        const double strict = speed * kContactTime_s + kRounding_m;
        if (depth <= strict) return;
        const bool two_owners =
            several_owners && body(a).owner >= 0 && body(b).owner >= 0 && body(a).owner != body(b).owner;
        if (two_owners && is_surprised(run, seconds(t))) {
          double fastest = 0.0;
          for (const auto& [at, each] : recent) fastest = std::max(fastest, each);
          if (depth <= allowed_by_surprise_m(fastest)) return;
          add(of + " truth too deep", body(a).name, " in ", body(b).name, " by ", depth, " m at ", seconds(t), " s, ",
              speed, " m/s, allowed ", allowed_by_surprise_m(fastest));
          return;
        }
        add(of + (two_owners ? " truth of two owners" : " truth of one owner"), body(a).name, " in ", body(b).name,
            " by ", depth, " m at ", seconds(t), " s, ", speed, " m/s");
      });
    }
  }

  void check_ghosts(const std::string& of, const Run& run) {
    std::map<std::string, double> first_s;
    std::map<std::tuple<std::string, std::size_t, std::size_t>, std::map<Nanos, double>> speeds;
    for (const auto& [when, states] : run.ghosts) {
      const auto& [observer, t] = when;
      const double t_s = seconds(t);
      // Who joins has some objects as the file has them until their owners' updates have come.
      if (t_s <= first_s.try_emplace(observer, t_s).first->second + window_s_ && t_s > window_s_) continue;
      each_pair(states, t_s,
                [&, &observer = observer, t = t](std::size_t a, std::size_t b, double depth, double speed) {
                  auto& recent = speeds[{observer, a, b}];
                  recent[t] = speed;
                  while (seconds(t - recent.begin()->first) > window_s_) recent.erase(recent.begin());
                  if (depth <= speed * kContactTime_s + kSame_m) return;
                  double fastest = 0.0;
                  for (const auto& [at, each] : recent) fastest = std::max(fastest, each);
                  const bool surprised = ghosts_are_surprised(run, t_s);
                  if (surprised && depth <= allowed_by_surprise_m(fastest)) return;
                  add(of + (surprised ? " ghosts too deep" : " ghosts"), observer, " shows ", body(a).name, " in ",
                      body(b).name, " by ", depth, " m at ", t_s, " s, ", speed, " m/s, allowed ",
                      surprised ? allowed_by_surprise_m(fastest) : 0.0);
                });
    }
  }

  // At one session time: peers' clocks may be some milliseconds apart after losses, and what moves is elsewhere then.
  void check_end(const std::string& of, const Run& run) {
    std::map<std::string, Nanos> last;
    for (const auto& [when, states] : run.ghosts) last[when.first] = std::max(last[when.first], when.second);
    for (const auto& [observer, t] : last) {
      if (seconds(t) < scene_.duration_s - 0.2) continue;
      for (const auto& [b, ghost] : run.ghosts.at({observer, t})) {
        if (!is_there(b, seconds(t))) continue;
        const auto truth = last_truth(run, b, t);
        if (!truth) {
          add(of + " end", body(b).name, " has no truth");
          continue;
        }
        const Vec3 is = advance(truth->second, seconds(t - truth->first)).position;
        const double off = (ghost.position - is).norm();
        // What drives an object is told up to its threshold, and so are contacts by dead reckoning alone.
        const bool is_rough = body(b).motion == Motion::kDriven || (scene_.approach == "dr" && !scene_.rests);
        if (off > (is_rough ? allowed_by_surprise_m(0.0) : kSame_m)) {
          add(of + (scene_.kind == "lift" ? " end on a lift" : " end"), observer, " shows ", body(b).name, ' ', off,
              " m off at ", seconds(t), " s, truth at ", is.transpose());
        }
      }
    }
    const std::size_t expected = scene_.peers.size() > 1 ? scene_.peers.size() - 1 : 0;
    if (last.size() < expected) add(of + " end", last.size(), " peers show others' objects, not ", expected);
  }

  // The greatest t at which all bodies have a truth.
  static Nanos end_of(const Run& run) { return run.truths.empty() ? 0 : run.truths.rbegin()->first; }

  void check_unique() {
    const Nanos t = std::min(end_of(run_), end_of(one_));
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      if (body(b).owner < 0 || !is_there(b, seconds(t))) continue;
      const auto one = last_truth(one_, b, t), several = last_truth(run_, b, t);
      if (!one || !several) {
        add("unique end", body(b).name, " has no truth");
        continue;
      }
      const Vec3 p = advance(one->second, seconds(t - one->first)).position;
      const Vec3 q = advance(several->second, seconds(t - several->first)).position;
      if ((p - q).norm() > kSame_m) {
        add("unique end", body(b).name, " ends at ", q.transpose(), ", and of one owner at ", p.transpose());
      }
    }
  }

  void check_rest(const Run& run) {
    if (!scene_.rests) return;
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      if (body(b).motion != Motion::kPhysics) continue;
      const auto last = last_truth(run, b, end_of(run));
      if (last && last->second.velocity.norm() > 1e-9) {
        add("one owner rest", body(b).name, " moves at ", last->second.velocity.transpose(), " m/s at the end");
      }
    }
  }

  struct Energy {
    double kinetic = 0.0, potential = 0.0;
    [[nodiscard]] double sum() const { return kinetic + potential; }
  };
  std::optional<Energy> energy(const States& states, double t_s) const {
    Energy sum;
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      if (body(b).motion != Motion::kPhysics) continue;
      const auto found = states.find(b);
      if (found == states.end()) return std::nullopt;
      sum.kinetic += 0.5 * body(b).mass_kg * found->second.velocity.squaredNorm();
      if (t_s < body(b).at_s) continue;  // it stands
      sum.potential -= body(b).mass_kg * body(b).acceleration.dot(found->second.position - body(b).at);
    }
    return sum;
  }
  std::vector<std::pair<Nanos, Energy>> energies(const Run& run) const {
    std::vector<std::pair<Nanos, Energy>> all;
    for (const auto& [t, states] : run.truths) {
      if (const auto e = energy(states, seconds(t))) all.emplace_back(t, *e);
    }
    return all;
  }
  // What energies are compared with: all that has come into motion.
  static double scale(const std::vector<std::pair<Nanos, Energy>>& all) {
    double most = 0.0, low = 0.0, high = 0.0;
    for (const auto& [t, e] : all) {
      most = std::max(most, e.kinetic);
      low = std::min(low, e.potential), high = std::max(high, e.potential);
    }
    return std::max(most, high - low) + 1e-6;
  }
  // The work of a driven support is not known: while something is driven nothing is compared. Inputs change it, too.
  bool has_input(double from_s, double to_s) const {
    if (scene_.is_driven() && from_s < scene_.driven_until_s) return true;
    return std::ranges::any_of(scene_.inputs_s, [&](double at_s) {
      return at_s > 0.0 && from_s - 1.0 / scene_.tick_hz <= at_s && at_s <= to_s + 1.0 / scene_.tick_hz;
    });
  }
  void check_energy(const Run& run) {
    const auto all = energies(run);
    const double of_all = scale(all);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < all.size(); ++i) {
      const double from = all[i - 1].second.sum(), to = all[i].second.sum();
      if (has_input(seconds(all[i - 1].first), seconds(all[i].first))) {
        least = std::numeric_limits<double>::infinity();
        continue;
      }
      least = std::min(least, from);
      const auto contacts = std::max<std::size_t>(1, contacts_between(run, all[i - 1].first, all[i].first));
      if (to > from + kRounding * double(contacts) * of_all) {
        add("one owner energy", "from ", from, " to ", to, " J (of ", of_all, ") until ", seconds(all[i].first),
            " s in ", contacts, " contacts");
      } else if (to > least + kEnergyOfRun * of_all) {
        add("one owner energy of the run", "from ", least, " to ", to, " J at ", seconds(all[i].first), " s");
      }
    }
  }
  static std::size_t contacts_between(const Run& run, Nanos from, Nanos to) {
    return std::size_t(
        std::ranges::count_if(run.answered, [&](const Answered& c) { return from <= c.at && c.at <= to; }));
  }
  void check_energy_at_rest(const Run& run) {
    if (!scene_.rests) return;
    const auto all = energies(run);
    const double of_all = scale(all);
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [t, e] : all) {
      if (seconds(t) < scene_.duration_s - 0.5) continue;
      if (e.sum() > least + kRounding * of_all)
        add("owners energy at rest", "from ", least, " to ", e.sum(), " J at ", seconds(t), " s");
      least = std::min(least, e.sum());
    }
  }

  void check_momentum(const std::string& of, const Run& run) {
    std::size_t moved = 0;
    for (const Body& each : scene_.bodies) moved += each.motion == Motion::kPhysics;
    if (!scene_.is_isolated) return;
    Vec3 wanted = Vec3::Zero();
    double most = 0.0;
    for (const auto& [t, states] : run.truths) {
      Vec3 sum = Vec3::Zero(), given = Vec3::Zero();
      double sizes = 0.0;
      std::size_t count = 0;
      for (const auto& [b, state] : states) {
        if (body(b).motion != Motion::kPhysics) continue;
        ++count;
        sum += body(b).mass_kg * state.velocity;
        sizes += body(b).mass_kg * state.velocity.norm();
        const double driven_s = std::max(0.0, seconds(t) - body(b).at_s);
        given += body(b).mass_kg * body(b).acceleration * driven_s;
        if (driven_s > 0.0) given += body(b).mass_kg * body(b).velocity;
      }
      if (count != moved) continue;
      most = std::max(most, sizes);
      // An owner that does not know of a blow yet has not taken its part of it.
      if (scene_.owners > 1 && is_surprised(run, seconds(t))) continue;
      if ((sum - given - wanted).norm() > kRounding * most + 1e-12) {
        add(of + " momentum", sum.transpose(), " Ns at ", seconds(t), " s, given ", given.transpose(), ", of ", sizes);
      }
    }
    if (moved != 2) return;
    for (const auto& [at, a, b, c] : run.answered) {
      const double m = body(a).mass_kg, n = body(b).mass_kg;
      const Vec3 before = m * c.collider_before.velocity + n * c.collidee_before.velocity;
      const Vec3 after = m * c.collider_after.velocity + n * c.collidee_after.velocity;
      const double sizes = m * c.collider_before.velocity.norm() + n * c.collidee_before.velocity.norm();
      if ((after - before).norm() > kRounding * sizes + 1e-12) {
        add(of + " momentum of a contact", "from ", before.transpose(), " to ", after.transpose(), " Ns at ",
            seconds(at), " s, of ", sizes);
      }
    }
  }

  const LastingScene& scene_;
  Run one_, run_;
  double way_s_ = 0.0, window_s_ = 0.0;
  std::map<std::string, int> counts_;
  std::vector<std::string> lines_;
};

}  // namespace

std::vector<std::string> faults_of(const LastingScene& scene, const std::string& folder, bool writes_states) {
  return Checks(scene, folder, writes_states).lines();
}

}  // namespace peerd::sim::lasting_scenes
