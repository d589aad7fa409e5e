// Question: what does libpeerd add to the calls inside it that do the work: to see where an object is, where 10,000
// are, and to move 10,000?
//
// embed_bench [--quick] [--out DIR] [--commit NAME]: one real peer on lo that owns 10,000 boxes and moves them by
// poses, each at a velocity of its own. In each round the call inside (PeerNode::advance_view and shown,
// Daemon::on_poses) and that of the library (peerd.h, peerd.hpp) do the same in turns; figures are medians of the
// rounds, those named "added" of the rounds' differences. Then the same for a peer with a thread of its own, which
// somebody holds or who waits for each call.
//
// Exit code 1: a library's pose is not that of the call inside it, a pose or a motion was refused, or an object is not
// where it was moved.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <random>
#include <span>
#include <stdexcept>
#include <thread>

#include "figures.hpp"
#include "peerd/daemon/embed/embedded_peer.hpp"
#include "peerd/daemon/embed/include/peerd/peerd.hpp"
#include "temporary_folder.hpp"

namespace peerd::bench {
namespace {

using embed::EmbeddedPeer;
using embed::Object;

constexpr double kSpacing_m = 3.0;
constexpr double kLift_m = 5.0;  // above their places in the world's file
// A pose without a time has that of its arrival, from which a box goes on for 0.1 s: some 0.3 m/s for as long.
constexpr double kOffMax_m = 0.2;
constexpr double kObserveAddedMax_ns = 200.0;
constexpr auto kGivesUpAfter = std::chrono::seconds(120);

std::string name_of(std::size_t box) { return "B" + std::to_string(box); }

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// A peer on lo, and the boxes that it owns.
class Boxes {
 public:
  explicit Boxes(std::size_t count) : peer_(options(count)) {
    await("it is in a session", [&] { return peer_.in_session(); });
    for (std::size_t i = 0; i < count; ++i) objects_.push_back(peer_.find(name_of(i)).value());
    await("it moves them", [&] { return move() == count; });
  }

  [[nodiscard]] embed::Peer& peer() { return peer_; }
  [[nodiscard]] EmbeddedPeer& inside() { return *reinterpret_cast<EmbeddedPeer*>(peer_.handle()); }
  [[nodiscard]] const std::vector<Object>& objects() const { return objects_; }
  [[nodiscard]] const std::vector<peerd_motion>& motions() const { return motions_; }
  [[nodiscard]] const std::vector<feed::FedPose>& fed() const { return fed_; }

  // Computes where the boxes are now, for the library and for the call inside it.
  void advance() {
    const double t = peer_.session_time().value();
    if (!began_) began_ = t;
    motions_.resize(objects_.size());
    fed_.resize(objects_.size());
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const Vec3 velocity(0.0, 0.0, 0.05 + 0.025 * static_cast<double>(i % 11));
      const Vec3 position = place_of(i) + kLift_m * Vec3::UnitY() + (t - *began_) * velocity;
      peerd_motion& motion = motions_[i];
      motion = {.object = objects_[i],
                .pose = embed::pose_of({position, Quat::Identity()}),
                .velocity = {},
                .jumps = 0,
                .reserved = 0};
      std::copy_n(velocity.data(), 3, motion.velocity);
      fed_[i].object = name_of(i);
      fed_[i].pose.position = position;
      fed_[i].pose.orientation = Quat::Identity();
      fed_[i].pose.velocity = velocity;
    }
    advanced_to_ = t;
  }
  std::size_t move() {
    advance();
    return peer_.move(motions_.data(), motions_.size());
  }
  // How far what was seen at that session time is from where the boxes were moved to and have gone since.
  [[nodiscard]] double off_m(std::span<const peerd_pose> seen, double at_s) const {
    const double since = at_s - advanced_to_;
    double worst = 0.0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Vec3 expected = Vec3(motions_[i].pose.position) + since * Vec3(motions_[i].velocity);
      worst = std::max(worst, (Vec3(seen[i].position) - expected).norm());
    }
    return worst;
  }
  void rest() {
    while (inside().node().next_deadline() <= inside().opened().clock().now()) peer_.poll(0.0);
  }

 private:
  [[nodiscard]] static Vec3 place_of(std::size_t box) {
    return {kSpacing_m * static_cast<double>(box % 100), 0.0, kSpacing_m * static_cast<double>(box / 100)};
  }
  [[nodiscard]] embed::Options options(std::size_t count) const {
    std::ofstream world(folder_ / "w.wrl"), settings(folder_ / "s.toml");
    world << "#VRML V2.0 utf8\n";
    std::string owns, motions;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 place = place_of(i);
      world << "DEF " << name_of(i) << " Transform { translation " << place.x() << " 0 " << place.z()
            << " children Shape { geometry Box { size 1 1 1 } } }\n";
      owns += (i == 0 ? "\"" : ", \"") + name_of(i) + '"';
      motions += name_of(i) + " = { outside = true }\n";
    }
    const int port = std::uniform_int_distribution(20'000, 30'000)(random_);
    settings << "world = \"w.wrl\"\n[peer.bench]\nid = 1\nowns = [" << owns << "]\n[peer.bench.motion]\n" << motions;
    return embed::Options()
        .set("config", (folder_ / "s.toml").string())
        .set("peer", "bench")
        .set("interface", "lo")
        .set("port", std::to_string(port))
        .set("open", "yes")
        .set("set", "replication.tick_hz=20")  // so that few ticks fall into a call
        .set("take-over", "yes");
  }
  void await(const char* what, const std::function<bool()>& holds) {
    const auto give_up = std::chrono::steady_clock::now() + kGivesUpAfter;
    while (!holds()) {
      if (std::chrono::steady_clock::now() > give_up) throw std::runtime_error(std::string("not after 120 s: ") + what);
      if (!peer_.poll(0.005)) throw std::runtime_error("the peer has left");
    }
  }

  mutable std::random_device random_;  // a port, so that other peers of this computer are left alone
  TemporaryFolder folder_;
  embed::Peer peer_;
  std::vector<Object> objects_;
  std::vector<peerd_motion> motions_;
  std::vector<feed::FedPose> fed_;
  std::optional<double> began_;  // session time [s]
  double advanced_to_ = 0.0;     // session time [s]
};

// Two ways to do the same thing `times` times, in turns.
struct Pair {
  std::string name;
  const char* unit;
  double per_second;  // units in a second
  std::size_t times;  // a round does it so often
  std::function<void()> before, inside, library;
};

std::vector<Figure> measure(const Pair& pair, int rounds) {
  std::vector<double> inside, library, added;
  for (int round = 0; round < rounds; ++round) {
    double took[2];
    for (const int turn : {0, 1}) {
      const bool is_library = (turn + round) % 2 == 1;
      pair.before();
      took[is_library] = seconds_of(is_library ? pair.library : pair.inside) * pair.per_second / double(pair.times);
    }
    inside.push_back(took[0]);
    library.push_back(took[1]);
    added.push_back(took[1] - took[0]);
  }
  const auto figure = [&](const char* what, const std::vector<double>& samples) {
    const Quartiles q = quartiles(samples);
    return Figure{pair.name + '.' + what, q.median, pair.unit, "", std::nullopt, q.low, q.high};
  };
  std::vector<Figure> figures{figure("inside", inside), figure("library", library), figure("added", added)};
  figures[1].against = figures[0].name;
  figures[1].ratio = figures[1].value / figures[0].value;
  return figures;
}

class Benchmark : public Report {
 public:
  explicit Benchmark(const Options& options)
      : Report(options),
        quick_(options.quick),
        boxes_(options.quick ? 200 : 10'000),
        rounds_(options.quick ? 3 : 101) {}

  int run(const Options& options) {
    add(poses("poses"));
    for (Pair& pair : observations("observe")) add(pair);
    add(moves("move"));
    compare_poses();
    boxes_.peer().start();
    rests_ = false;
    add(observation_of_a_thread());
    {
      const embed::Peer::Hold held(boxes_.peer());
      for (Pair& pair : observations("observe_held")) add(pair);
    }
    if (!quick_) {
      for (const char* name :
           {"observe.c.added", "observe.cpp.added", "observe_held.c.added", "observe_held.cpp.added"}) {
        target(name);
      }
    }
    for (const Figure& f : figures_) {
      std::printf("%-28s %12.1f %s  (%.1f to %.1f)\n", f.name.c_str(), f.value, f.unit.c_str(), f.low, f.high);
    }
    if (!write_figures(options, figures_)) return 3;
    return right_ ? 0 : 1;
  }

 private:
  void add(const Pair& pair) {
    for (Figure& figure : measure(pair, rounds_)) Report::add(std::move(figure));
  }
  void target(const std::string& name) {
    const auto at = std::ranges::find(figures_, name, &Figure::name);
    at->against = "target: 200 ns";
    at->ratio = at->value / kObserveAddedMax_ns;
  }
  void rest() {
    if (rests_) boxes_.rest();
  }

  // The same as the library does it inside: where the object is now.
  Pose seen_inside(Object object) {
    PeerNode& node = boxes_.inside().opened().node();
    seen_at_ = node.advance_view(boxes_.inside().opened().daemon().now(), seen_at_);
    return node.shown(ObjectId::unpacked(object), *seen_at_);
  }

  Pair poses(const std::string& name) {
    const auto& objects = boxes_.objects();
    inside_.resize(objects.size());
    library_.resize(objects.size());
    return {.name = name,
            .unit = "us",
            .per_second = 1e6,
            .times = 1,
            .before = [this] { rest(); },
            .inside =
                [&] {
                  PeerNode& node = boxes_.inside().opened().node();
                  seen_at_ = node.advance_view(boxes_.inside().opened().daemon().now(), seen_at_);
                  for (std::size_t i = 0; i < objects.size(); ++i) {
                    inside_[i] = node.shown(ObjectId::unpacked(objects[i]), *seen_at_);
                  }
                },
            .library =
                [&] {
                  const std::size_t found =
                      peerd_poses(boxes_.peer().handle(), objects.data(), objects.size(), library_.data());
                  if (found != objects.size()) wrong("poses: not of all objects");
                }};
  }

  // A picture is not later than the tick that is due, so that both see the same instant while nobody polls.
  void compare_poses() {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const Pair pair = poses("poses");
    pair.inside();
    pair.library();
    const auto is_same = [](const Pose& a, const peerd_pose& b) {
      const peerd_pose pose = embed::pose_of(a);
      return std::memcmp(&pose, &b, sizeof b) == 0;
    };
    if (!std::ranges::equal(inside_, library_, is_same)) {
      wrong("the library's poses are not those of the calls inside");
    }
    const double off_m = boxes_.off_m(library_, to_seconds(seen_at_->time_since_epoch()));
    if (!(off_m <= kOffMax_m)) wrong("boxes are off by " + std::to_string(off_m) + " m");
  }

  // One pose a call, by C and by C++.
  std::vector<Pair> observations(const std::string& name) {
    const std::size_t times = quick_ ? 100 : 2000;
    const auto each = [this, times](const auto& see) {
      for (std::size_t i = 0; i < times; ++i) sum_ += see(boxes_.objects()[i * 7919 % boxes_.objects().size()]);
    };
    const auto inside = [this, each] { each([&](Object o) { return seen_inside(o).position.z(); }); };
    const auto by_c = [this, each] {
      each([&](Object o) {
        peerd_pose pose{};
        if (peerd_poses(boxes_.peer().handle(), &o, 1, &pose) != 1) wrong("no pose");
        return pose.position[2];
      });
    };
    const auto by_cpp = [this, each] { each([&](Object o) { return boxes_.peer().pose(o).value().position[2]; }); };
    const auto before = [this] { rest(); };
    return {{name + ".c", "ns", 1e9, times, before, inside, by_c},
            {name + ".cpp", "ns", 1e9, times, before, inside, by_cpp}};
  }

  // The peer has a thread, which is to be woken for each call that nobody holds it for.
  Pair observation_of_a_thread() {
    Pair pair = observations("observe_waiting").front();
    pair.times = quick_ ? 10 : 100;
    const auto see = [this, times = pair.times](const auto& one) {
      for (std::size_t i = 0; i < times; ++i) sum_ += one(boxes_.objects()[i]);
    };
    pair.inside = [this, see] {
      const embed::Peer::Hold held(boxes_.peer());
      see([&](Object o) { return seen_inside(o).position.z(); });
    };
    pair.library = [this, see] { see([&](Object o) { return boxes_.peer().pose(o).value().position[2]; }); };
    return pair;
  }

  Pair moves(const std::string& name) {
    return {.name = name,
            .unit = "us",
            .per_second = 1e6,
            .times = 1,
            .before =
                [this] {
                  rest();
                  boxes_.advance();
                },
            .inside =
                [this] {
                  const auto outcome = boxes_.inside().opened().daemon().on_poses(boxes_.fed());
                  if (outcome.taken != boxes_.fed().size()) wrong("the call inside refuses motions");
                },
            .library =
                [this] {
                  const auto& motions = boxes_.motions();
                  const auto taken = peerd_move(boxes_.peer().handle(), motions.data(), motions.size());
                  if (taken != motions.size()) wrong("peerd_move refuses motions");
                }};
  }

  bool quick_;
  Boxes boxes_;
  int rounds_;
  bool rests_ = true;
  std::optional<SimTime> seen_at_;
  std::vector<Pose> inside_;
  std::vector<peerd_pose> library_;
  double sum_ = 0.0;
};

int run(const Options& options) { return Benchmark(options).run(options); }

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) { return peerd::bench::run_main(argc, argv, peerd::bench::run); }
