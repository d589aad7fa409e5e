// bridge WORLD OWN [NAME VALUE]..: a physics engine of its own (engine.hpp) shares the balls of bridge.wrl with other
// engines. It owns one of them, BALL or TARGET. BALL is thrown at TARGET as soon as both have an owner; both programs
// say what came of it, and end. More options are those of peerd_options_set().
//
// What an engine and peerd have to do with each other:
//   own bodies go out      the engine steps them, and move() says each frame where they are, with their velocity
//   others' come in        as kinematic bodies, which follow the poses that peerd shows
//   contacts with others'  peerd finds them and says who decides; each engine applies the impulse to its own body
//   ownership              an object that changes hands becomes a dynamic or a kinematic body
#include "engine.hpp"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <iostream>
#include <list>
#include <map>
#include <peerd/peerd.hpp>
#include <string>
#include <utility>

using namespace peerd::embed;

namespace {

constexpr double kFrame_s = 1.0 / 60.0, kThrown = 3.0;  // [m/s]
constexpr double kRestitution = 0.9;                    // as in bridge.wrl
// An engine answers a contact a frame late, and other peers hear of that later still. Until then peerd finds the two
// meeting again; for so long after a contact that is the same one.
constexpr double kSameContact_s = 0.1;

// The balls are as in bridge.wrl, so that all engines have the same.
double mass_of(const std::string& path) { return path == "TARGET" ? 2.0 : 1.0; }

class Bridge {
 public:
  explicit Bridge(Peer& peer) : peer_(peer) {}

  void add(const std::string& path) {
    engine::Body body;
    body.mass_kg = mass_of(path);
    body.kinematic = true;
    bodies_[peer_.find(path).value()] = &world_.add(body);
  }
  engine::Body& body(Object object) { return *bodies_.at(object); }

  // One frame of the engine, at that session time, so long after the one before: others' bodies come in, contacts come
  // in, own bodies go out.
  void frame(double now, double took_s) {
    engine_time_ = now - took_s - rest_s_;
    while (const auto event = peer_.next_event()) take(*event);
    follow(took_s);
    for (rest_s_ += took_s; rest_s_ >= engine::kStep_s; rest_s_ -= engine::kStep_s) world_.step();
    publish();
  }
  std::size_t contacts() const { return impulses_.size(); }

 private:
  // The change that a contact has made to an own body, to be taken back if another peer had decided it otherwise.
  struct Impulse {
    double at;
    Object object, other;
    Vector change;  // of the own body's velocity
  };

  void take(const Event& event) {
    if (event.kind == PEERD_OBJECT_GIVEN) give(event.object, event.peer);
    if (event.kind == PEERD_CONTACT) answer(event);
    if (event.kind == PEERD_CONTACT_OVERRULED) revoke(event);
  }

  void give(Object object, std::uint32_t owner) {
    const auto at = bodies_.find(object);
    if (at == bodies_.end()) return;
    engine::Body& body = *at->second;
    body.kinematic = owner != peer_.id();
    if (body.kinematic) return;
    body.position = peer_.pose(object).value().position;  // where all peers have it
    body.velocity = {};
  }

  // A contact of an own body with one of another peer, which this peer or the other one has decided. Everything that
  // the impulse depends on comes from the event, so that both engines compute the same one. It happened a moment ago:
  // the body goes on from there, as it would have gone with the velocity that it has since.
  void answer(const Event& contact) {
    const bool is_first = peer_.owner(contact.object) == peer_.id();
    const Object own = is_first ? contact.object : contact.other, met = is_first ? contact.other : contact.object;
    if (peer_.owner(own) != peer_.id() || peer_.owner(met) == peer_.id()) return;  // of others, or the engine's own
    if (is_known(contact)) return;
    engine::Body &a = body(contact.object), &b = body(contact.other);
    double closing = 0.0;
    for (int i = 0; i < 3; ++i) {
      closing -= contact.normal[i] * (contact.velocity_before[i] - contact.other_velocity_before[i]);
    }
    if (closing <= 0.0) return;
    const double impulse = (1.0 + kRestitution) * closing / (1.0 / a.mass_kg + 1.0 / b.mass_kg);
    Impulse done{contact.time, contact.object, contact.other, {}};
    for (int i = 0; i < 3; ++i)
      done.change[i] = (is_first ? impulse : -impulse) / body(own).mass_kg * contact.normal[i];
    apply(body(own), done.change, contact.time);
    impulses_.push_back(done);
    std::cout << "contact at " << contact.time << " s, decided by " << contact.peer << ": impulse " << impulse
              << " kg m/s" << std::endl;
  }

  bool is_known(const Event& contact) const {
    return std::any_of(impulses_.begin(), impulses_.end(), [&](const Impulse& done) {
      return done.object == contact.object && done.other == contact.other && contact.time < done.at + kSameContact_s;
    });
  }

  void revoke(const Event& overruled) {
    for (auto done = impulses_.begin(); done != impulses_.end(); ++done) {
      if (done->at != overruled.time || done->object != overruled.object || done->other != overruled.other) continue;
      Vector back{};
      for (int i = 0; i < 3; ++i) back[i] = -done->change[i];
      const bool is_first = peer_.owner(done->object) == peer_.id();
      apply(body(is_first ? done->object : done->other), back, done->at);
      impulses_.erase(done);
      return;
    }
  }

  void apply(engine::Body& body, const Vector& change, double since) const {
    for (int i = 0; i < 3; ++i) {
      body.velocity[i] += change[i];
      body.position[i] += change[i] * (engine_time_ - since);
    }
  }

  // A kinematic body arrives with the next frame where peerd shows it now; its velocity is the way from here to there.
  void follow(double took_s) {
    for (const auto& [object, body] : bodies_) {
      const auto pose = body->kinematic ? peer_.pose(object) : std::nullopt;
      if (!pose || took_s <= 0.0) continue;
      for (int i = 0; i < 3; ++i) body->velocity[i] = (pose->position[i] - body->position[i]) / took_s;
    }
  }

  // The engine is at a whole number of steps, a little before the present: what is left of a step is interpolated.
  void publish() {
    for (const auto& [object, body] : bodies_) {
      if (body->kinematic) continue;
      Pose pose;
      for (int i = 0; i < 3; ++i) pose.position[i] = body->position[i] + body->velocity[i] * rest_s_;
      peer_.move(object, pose, body->velocity);
    }
  }

  Peer& peer_;
  engine::World world_;
  std::map<Object, engine::Body*> bodies_;
  std::list<Impulse> impulses_;
  double rest_s_ = 0.0;       // of the time that has gone by, what is no whole step
  double engine_time_ = 0.0;  // session time at which the bodies are where they are, before the steps of this frame
};

// The engine's loop. Between two frames the peer works: it sends, it receives, it finds contacts.
void run(Peer& peer, const std::string& own) {
  Bridge bridge(peer);
  for (const char* path : {"BALL", "TARGET"}) bridge.add(path);
  const Object mine = peer.find(own).value(), other = peer.find(own == "BALL" ? "TARGET" : "BALL").value();
  bool is_asked = false, is_thrown = false;
  double last = 0.0, ends = 0.0;
  for (auto next = std::chrono::steady_clock::now();;) {
    next += std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(kFrame_s));
    for (;;) {
      const std::chrono::duration<double> left = next - std::chrono::steady_clock::now();
      if (!peer.poll(std::max(left.count(), 0.0))) return;
      if (left.count() <= 0.0) break;
    }
    if (!peer.in_session()) continue;
    const double now = peer.session_time().value();
    bridge.frame(now, last > 0.0 ? now - last : 0.0);
    last = now;
    if (!std::exchange(is_asked, true)) peer.take(mine);
    if (!is_thrown && peer.owner(mine) == peer.id() && peer.owner(other) != 0) {
      if (own == "BALL") bridge.body(mine).velocity[0] = kThrown;
      is_thrown = true;
    }
    if (bridge.contacts() > 0 && ends == 0.0) ends = now + 1.0;
    if (ends > 0.0 && now > ends) break;
  }
  const double apart = peer.pose(other).value().position[0] - peer.pose(mine).value().position[0];
  std::cout << own << " goes with " << bridge.body(mine).velocity[0] << " m/s; at " << peer.session_time().value()
            << " s the other one is " << apart << " m away" << std::endl;
  for (int i = 0; i < 100; ++i) peer.poll(0.005);  // the other one is to see it, too
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: bridge WORLD BALL|TARGET [NAME VALUE]..\n";
    return 2;
  }
  try {
    Options options;
    options.set("world", argv[1]).set("name", argv[2]);
    for (int i = 3; i + 1 < argc; i += 2) options.set(argv[i], argv[i + 1]);
    Peer peer(options);
    std::cout << std::fixed << std::setprecision(6);
    run(peer, argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "bridge: " << error.what() << '\n';
    return 1;
  }
}
