// Question: what do a ghost, a datagram and a tick cost a peer, and how does that grow with the number of objects?
//
// wire_bench [--quick] [--out DIR] [--commit NAME] [OWN..]: one peer runs an eleventh of all objects, driven at 60 Hz
// along sums of waves; ten others run a tenth of the rest each. One of the ten is a whole peer that dead-reckons its
// objects; the other nine say what it says of objects of their own, datagram by datagram, so that updates come as often
// as dead reckoning needs. Everything arrives after 20 ms. Models: `best` as in configs/best.toml, `order2` the seed's
// second order with the objects' own thresholds (0.5 m). No interests.
//
// Times are of the thread, so what else runs here doesn't count. tick_share_of_core: of 10,000 ghosts and 1,000 own
// objects, what on_packet, on_tick, draining the outputs and evaluating every ghost at every tick take of a simulated
// second. bytes_over_dis, flock_received_over_aoi: wire_traffic.hpp. OWN: only ticks, with so many own objects;
// `loopback`: only how long an update is under way (loopback/). Writes wire-growth.csv and wire-growth.svg besides.
// Exit code 1: a ghost is not what its owner's update says or not, to the last bit, what its owner believes of it; not
// all that was sent was applied; a record is not decoded as it was encoded.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <deque>
#include <random>
#include <string>
#include <vector>

#include "collision_chart.hpp"
#include "core/vrml/reader.hpp"
#include "figures.hpp"
#include "loopback/loopback.hpp"
#include "replication/peer.hpp"
#include "replication/record.hpp"
#include "wire_traffic.hpp"

namespace peerd::bench {
namespace {

using namespace replication;
using namespace std::chrono_literals;

constexpr std::uint32_t kOthers = 10;
constexpr Duration kLatency = 20ms, kFrame = Duration{1'000'000'000 / 60};
constexpr Tolerance kRounded{0.05, 0.05};  // of a record in a batch

double thread_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// What it takes to run f.
template <class F>
double seconds_of(const F& f) {
  const double begin = thread_s();
  f();
  return thread_s() - begin;
}

bool same_bits(const KinematicState& a, const KinematicState& b) {
  return a.position == b.position && a.velocity == b.velocity && a.acceleration == b.acceleration &&
         a.orientation.coeffs() == b.orientation.coeffs() && a.angular_velocity_body == b.angular_velocity_body;
}

// Whether the ghost is where the update says: but for the turn, which is normalised once more, to the last bit; pieces
// of laws that are cut may be off by kPieceError_m and kPieceError_rad.
bool as_told(const KinematicState& ghost, const UpdateRecord& told, SimTime t) {
  const MotionModel& m = told.model;
  const KinematicState says = evaluate(m, to_seconds(t - told.at));
  const bool cut = m.kind == MotionKind::kThird || m.kind == MotionKind::kTurning ||
                   m.kind == MotionKind::kOscillating || !m.angular_acceleration_body.isZero(0.0);
  const bool there = cut ? (ghost.position - says.position).norm() <= kPieceError_m : ghost.position == says.position;
  return there && angle_between(ghost.orientation, says.orientation) <= kPieceError_rad;
}

// Objects without a shape or an interest, side by side in the file.
struct Crowd {
  explicit Crowd(std::size_t objects) {
    std::string text = "#VRML V2.0 utf8\n";
    for (std::size_t i = 0; i < objects; ++i) text += "DEF O" + std::to_string(i) + " Transform { }\n";
    ReadResult read = read_world(text);
    scene = std::move(read.scene.value());
    model = make_world_model(scene);
    first = scene.find("O0").value();
  }
  [[nodiscard]] ObjectId object(std::size_t i) const { return ObjectId{first.value + static_cast<std::uint32_t>(i)}; }

  Scene scene;
  std::unique_ptr<const WorldModel> model;
  ObjectId first;
};

// Walks and drives: on each axis of the ground two waves of 5 to 60 s, at up to 12 m/s, looking where it goes.
class Path {
 public:
  explicit Path(std::mt19937_64& rng) {
    const auto draw = [&](double from, double to) {
      return from + (to - from) * std::ldexp(static_cast<double>(rng() >> 11), -53);
    };
    for (auto& axis : waves_) {
      for (Wave& w : axis) {
        w.rate = 2.0 * 3.141592653589793 / draw(5.0, 60.0);
        w.size_m = draw(0.2, 3.0) / w.rate;
        w.phase = draw(0.0, 6.28);
      }
    }
    middle_ = {draw(-500, 500), 0.0, draw(-500, 500)};
  }

  [[nodiscard]] KinematicState at(SimTime time) const {
    const double t = to_seconds(time.time_since_epoch());
    KinematicState s;
    s.position = middle_;
    for (int i = 0; i < 2; ++i) {
      for (const Wave& w : waves_[static_cast<std::size_t>(i)]) {
        const double sin = std::sin(w.rate * t + w.phase), cos = std::cos(w.rate * t + w.phase);
        s.position[2 * i] += w.size_m * sin;
        s.velocity[2 * i] += w.size_m * w.rate * cos;
        s.acceleration[2 * i] -= w.size_m * w.rate * w.rate * sin;
      }
    }
    const double speed2 = s.velocity.squaredNorm();
    s.orientation = quat_exp({0.0, std::atan2(s.velocity.x(), s.velocity.z()), 0.0});
    // At a standstill it turns on the spot, as fast as it can.
    const double turns = s.velocity.z() * s.acceleration.x() - s.velocity.x() * s.acceleration.z();
    s.angular_velocity_body.y() = std::clamp(turns / std::max(speed2, 1e-6), -3.0, 3.0);
    return s;
  }

 private:
  struct Wave {
    double size_m = 0.0, rate = 0.0, phase = 0.0;
  };
  std::array<std::array<Wave, 2>, 2> waves_;
  Vec3 middle_;
};

PublishPolicy policy_of(bool best) {
  PublishPolicy policy;
  if (!best) return policy;
  policy.refine_proximity = true;
  policy.surface_error = true;
  policy.angle_threshold_rad = 15.0 * 3.141592653589793 / 180.0;
  policy.models.emplace();
  policy.models->allowed[0] = false;  // kFirst
  policy.wanted_error_m = 0.005;
  policy.updates_per_s = 1.9;
  policy.copies = 4;
  return policy;
}

struct Cost {
  double packets_s = 0.0, ticks_s = 0.0, ghosts_s = 0.0;  // of simulated_s
  double simulated_s = 0.0, ghost_ns = 0.0;
  std::uint64_t datagrams = 0, updates = 0;
  std::vector<double> shares;  // second by second
  [[nodiscard]] double share() const { return (packets_s + ticks_s + ghosts_s) / simulated_s; }
};

// The measured peer, the whole one of the others, and those that say what that one says.
class Town {
 public:
  Town(std::size_t own_count, bool best)
      : own_count_(own_count),
        crowd_((1 + kOthers) * own_count),
        measured_(config_of(1, 0, best), *crowd_.model),
        sender_(config_of(1 + kOthers, kOthers, best), *crowd_.model) {
    std::mt19937_64 rng(own_count);
    for (std::size_t i = 0; i < 2 * own_count; ++i) paths_.emplace_back(rng);
  }

  void run(Duration until, Cost* cost) {
    const HostTime end{until};
    while (now_ < end) {
      now_ = std::min({end, measured_.next_deadline() == HostTime::min() ? now_ : measured_.next_deadline(),
                       sender_.next_deadline() == HostTime::min() ? now_ : sender_.next_deadline(),
                       flights_.empty() ? end : std::max(now_, flights_.front().at)});
      while (!flights_.empty() && flights_.front().at <= now_) {
        deliver(flights_.front(), cost);
        flights_.pop_front();
      }
      if (sender_.next_deadline() <= now_) {
        sender_.on_tick(now_, samples(sender_, kOthers, own_count_));
        drain(sender_, true);
      }
      if (measured_.next_deadline() <= now_) tick(cost);
    }
  }

  // Whether everybody believes the same of everything, once nothing is under way.
  [[nodiscard]] std::size_t differences() {
    for (; !flights_.empty(); flights_.pop_front()) {
      now_ = std::max(now_, flights_.front().at);
      deliver(flights_.front(), nullptr);
    }
    const SimTime t = measured_.clock().to_session(now_);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < own_count_; ++i) {
      const KinematicState believed = sender_.ghost(object(kOthers, i), t);
      for (std::size_t k = 1; k <= kOthers; ++k) wrong += !same_bits(measured_.ghost(object(k, i), t), believed);
    }
    return wrong + (measured_.owners().size() != (1 + kOthers) * own_count_);
  }
  // How many ghosts are elsewhere than the update that was applied last says.
  [[nodiscard]] std::size_t elsewhere() const {
    const SimTime t = measured_.clock().to_session(now_);
    return static_cast<std::size_t>(std::ranges::count_if(told_, [&](const UpdateRecord& told) {
      return told.sequence > 0 && !as_told(measured_.ghost(told.object, t), told, t);
    }));
  }
  [[nodiscard]] std::uint64_t not_applied() const { return delivered_ - measured_.counters().updates_in; }
  [[nodiscard]] std::size_t told() const {
    return static_cast<std::size_t>(std::ranges::count_if(told_, [](const UpdateRecord& u) { return u.sequence > 0; }));
  }

  // One ghost [ns], all of them after each other, frame by frame.
  [[nodiscard]] double ghost_ns(int rounds) {
    const SimTime t = measured_.clock().to_session(now_);
    double sum = 0.0;
    const double s = seconds_of([&] {
      for (int round = 0; round < rounds; ++round) sum += look(t + round * kFrame);
    });
    seen_ += sum;
    return 1e9 * s / (rounds * static_cast<double>(kOthers * own_count_));
  }
  [[nodiscard]] double seen() const { return seen_; }

 private:
  struct Flight {
    HostTime at;
    bool to_sender;
    Bytes datagram;
  };

  // Of block 0 the measured peer's, of block k those of the peer 1 + k.
  [[nodiscard]] ObjectId object(std::size_t block, std::size_t i) const {
    return crowd_.object(block * own_count_ + i);
  }

  [[nodiscard]] PeerConfig config_of(std::uint32_t id, std::size_t block, bool best) const {
    PeerConfig c;
    c.id = PeerId{id};
    c.name = "peer" + std::to_string(id);
    c.world_hash = 1;
    c.policy = policy_of(best);
    for (std::size_t i = 0; i < own_count_; ++i) c.enslaved.push_back({object(block, i), true, {}});
    return c;
  }
  [[nodiscard]] std::vector<OwnSample> samples(const Peer& peer, std::size_t block, std::size_t first_path) const {
    std::vector<OwnSample> all;
    const auto due = peer.due_tick(now_);
    if (!due) return all;
    all.reserve(own_count_);
    for (std::size_t i = 0; i < own_count_; ++i) {
      all.push_back({object(block, i), paths_[first_path + i].at(*due), true});
    }
    return all;
  }
  double look(SimTime t) const {
    double sum = 0.0;
    for (std::size_t i = own_count_; i < (1 + kOthers) * own_count_; ++i) {
      sum += measured_.ghost(crowd_.object(i), t).position.x();
    }
    return sum;
  }

  void tick(Cost* cost) {
    const std::vector<OwnSample> moved = samples(measured_, 0, 0);
    const double s = seconds_of([&] {
      measured_.on_tick(now_, moved);
      drain(measured_, false);
    });
    if (cost == nullptr) return;
    cost->ticks_s += s;
    if (moved.empty()) return;
    const SimTime t = measured_.clock().to_session(now_);
    cost->ghosts_s += seconds_of([&] { seen_ += look(t); });
  }
  void deliver(const Flight& flight, Cost* cost) {
    if (flight.to_sender) {
      (void)sender_.on_packet(now_, kWholeScene, flight.datagram);
      drain(sender_, true);
      return;
    }
    bool used = false;
    const double s = seconds_of([&] {
      used = measured_.on_packet(now_, kWholeScene, flight.datagram).has_value();
      drain(measured_, false);
    });
    const Message m = decode(flight.datagram, measured_.clock().to_session(now_)).value();
    std::uint64_t applied = 0;
    for (const UpdateRecord& u : m.updates) {
      if (!used) continue;
      if (told_.size() <= u.object.value) told_.resize(u.object.value + 1);
      UpdateRecord& last = told_[u.object.value];
      if (u.sequence <= last.sequence) continue;
      last = u;
      ++applied;
    }
    delivered_ += applied;
    if (cost == nullptr) return;
    cost->packets_s += s;
    ++cost->datagrams;
    cost->updates += applied;
  }
  // Only what is sent is of interest; the measured peer's observer would have taken the rest.
  void drain(Peer& peer, bool is_sender) {
    while (auto out = peer.poll_output()) {
      auto* send = std::get_if<Send>(&*out);
      if (send == nullptr) continue;
      if (is_sender) {
        say_for_all(send->datagram);
      } else {
        flights_.push_back({now_ + kLatency, true, std::move(send->datagram)});
      }
    }
  }
  void say_for_all(const Bytes& datagram) {
    const Message said = decode(datagram, sender_.clock().to_session(now_)).value();
    for (std::uint32_t k = 1; k <= kOthers; ++k) {
      Message m = said;
      const auto shifted = [&](ObjectId o) {
        return ObjectId{o.value - static_cast<std::uint32_t>((kOthers - k) * own_count_)};
      };
      m.sender = PeerId{1 + k};
      if (m.introduction() != nullptr) {
        for (ObjectId& o : m.hello->introduction->enslaved) o = shifted(o);
      }
      for (UpdateRecord& u : m.updates) u.object = shifted(u.object);
      flights_.push_back({now_ + kLatency, false, encode(m)});
    }
  }

  std::size_t own_count_;
  Crowd crowd_;
  Peer measured_, sender_;
  std::vector<Path> paths_;  // the measured peer's, then the sender's
  std::deque<Flight> flights_;
  HostTime now_{0s};
  std::vector<UpdateRecord> told_;  // by object: what was delivered last
  std::uint64_t delivered_ = 0;
  double seen_ = 0.0;
};

// Updates of objects that walk and drive, each newer than all before.
class Updates {
 public:
  explicit Updates(const Crowd& crowd, std::size_t objects) : crowd_(crowd), objects_(objects), rng_(7) {}

  UpdateRecord next(SimTime at) {
    UpdateRecord u;
    u.object = crowd_.object(made_ % objects_);
    u.sequence = static_cast<std::uint32_t>(1 + made_ / objects_);
    u.at = at;
    KinematicState& s = u.model.state;
    s.position = {draw(500.0), draw(20.0), draw(500.0)};
    s.velocity = {draw(10.0), 0.0, draw(10.0)};
    s.acceleration = {draw(2.0), 0.0, draw(2.0)};
    s.orientation = quat_exp({0.0, draw(3.0), 0.0});
    s.angular_velocity_body.y() = draw(1.0);
    ++made_;
    return quantised(u, kRounded);
  }

 private:
  double draw(double most) { return most * (2.0 * std::ldexp(static_cast<double>(rng_() >> 11), -53) - 1.0); }

  const Crowd& crowd_;
  std::size_t objects_;
  std::mt19937_64 rng_;
  std::size_t made_ = 0;
};

bool same_record(const UpdateRecord& a, const UpdateRecord& b) {
  return a.object == b.object && a.sequence == b.sequence && a.at == b.at && a.model.kind == b.model.kind &&
         same_bits(a.model.state, b.model.state);
}

class Bench {
 public:
  explicit Bench(const Options& options) : options_(options) {}

  int run() {
    const bool only_loopback = options_.arguments == std::vector<std::string>{"loopback"};
    if (options_.arguments.empty() || only_loopback) loopback();  // first: it forks, while this process is small
    if (only_loopback) return write_figures(options_, figures_) && right_ ? 0 : 1;
    if (options_.arguments.empty()) {
      for (const Figure& f : wire_traffic(options_)) add(f);
    }
    if (options_.arguments.empty()) {
      decode_and_apply(1);
      decode_and_apply(40);
      encode_batches();
    }
    const std::size_t headline = options_.quick ? 40 : 1000;
    std::vector<std::size_t> own_counts{10, 100, 1000, 10'000};
    if (options_.quick) own_counts = {10, headline};
    if (!options_.arguments.empty()) own_counts.clear();
    for (const std::string& argument : options_.arguments) own_counts.push_back(std::stoul(argument));
    for (const bool best : {true, false}) {
      for (const std::size_t own : own_counts) town(own, best, own == headline);
    }
    const bool written = write_figures(options_, figures_) && write_beside(options_, "wire-growth.csv", csv_) &&
                         write_beside(options_, "wire-growth.svg", draw(charts(), 2));
    return written && right_ ? 0 : 1;
  }

 private:
  void wrong(const std::string& what, std::uint64_t count) {
    if (count == 0) return;
    std::printf("WRONG: %s: %llu\n", what.c_str(), static_cast<unsigned long long>(count));
    right_ = false;
  }
  void figure(const std::string& name, const std::vector<double>& samples, const char* unit, const char* target,
              double target_value) {
    const Quartiles q = quartiles(samples);
    const auto ratio = target_value > 0.0 ? std::optional(q.median / target_value) : std::nullopt;
    add({name, q.median, unit, target, ratio, q.low, q.high});
  }
  void add(const Figure& f) {
    std::printf("%-44s %12.5g %-12s [%.5g %.5g] %s\n", f.name.c_str(), f.value, f.unit.c_str(), f.low, f.high,
                f.against.c_str());
    std::fflush(stdout);
    figures_.push_back(f);
  }

  void loopback() {
    const LoopbackResult result = measure_loopback(options_.quick);
    for (const std::string& what : result.wrong) wrong(what, 1);
    for (const Figure& f : result.figures) add(f);
  }

  // Datagrams of so many updates each, of 10,000 objects, through on_packet; ticks run between them, untimed.
  void decode_and_apply(std::size_t batch) {
    const std::size_t objects = options_.quick ? 200 : 10'000, rounds = options_.quick ? 2 : 20;
    const std::size_t datagrams = options_.quick ? 400 : batch == 1 ? 20'000 : 1'000;  // a round
    const Crowd crowd(objects);
    PeerConfig config;
    config.id = PeerId{1};
    config.world_hash = 1;
    Peer peer(std::move(config), *crowd.model);
    HostTime now{0s};
    for (; now < HostTime{2s}; now += 100ms) peer.on_tick(now, {});
    Message m;
    m.sender = PeerId{2};
    m.boot = 1;
    Hello& hello = m.hello.emplace();
    hello.session_tx = peer.clock().to_session(now);
    Introduction& introduction = hello.introduction.emplace();
    introduction.name = "peer2";
    introduction.world_hash = 1;
    wrong("hello", !peer.on_packet(now, kWholeScene, encode(m)).has_value());
    m.hello.reset();
    Updates updates(crowd, objects);
    std::vector<UpdateRecord> last(objects);
    std::vector<double> per_s, records_per_s;
    for (std::size_t round = 0; round <= rounds; ++round) {  // the first one warms up
      now += 1s;
      peer.on_tick(now, {});
      while (peer.poll_output()) {
      }
      const SimTime at = peer.clock().to_session(now) - 10ms;
      std::vector<Bytes> sent;
      for (std::size_t d = 0; d < datagrams; ++d) {
        ++m.number;
        m.updates.clear();
        for (std::size_t i = 0; i < batch; ++i) {
          m.updates.push_back(updates.next(at + Duration{static_cast<std::int64_t>(d)}));
          last[m.updates.back().object.value - crowd.first.value] = m.updates.back();
        }
        sent.push_back(encode(m));
      }
      const std::uint64_t before = peer.counters().updates_in;
      const double s = seconds_of([&] {
        for (const Bytes& datagram : sent) (void)peer.on_packet(now, kWholeScene, datagram);
      });
      wrong("updates that were not applied", datagrams * batch - (peer.counters().updates_in - before));
      if (round == 0) continue;
      per_s.push_back(static_cast<double>(datagrams) / s);
      records_per_s.push_back(static_cast<double>(datagrams * batch) / s);
    }
    const SimTime t = peer.clock().to_session(now);
    std::uint64_t elsewhere = 0;
    for (const UpdateRecord& u : last) {
      if (u.sequence == 0) continue;
      elsewhere += !as_told(peer.ghost(u.object, t), u, t);
    }
    wrong("ghosts that are not what their update says", elsewhere);
    if (batch == 1) {
      figure("decode_apply_per_s", per_s, "datagrams/s", ">= 100000", 1e5);
    } else {
      const std::string name = "decode_apply_per_s.batch" + std::to_string(batch);
      figure(name, per_s, "datagrams/s", "", 0.0);
      figure(name + ".records", records_per_s, "records/s", "", 0.0);
    }
  }

  void encode_batches() {
    constexpr std::size_t kBatch = 40;
    const std::size_t batches = options_.quick ? 10 : 500, rounds = options_.quick ? 2 : 21;
    const Crowd crowd(10'000);
    Updates updates(crowd, 10'000);
    std::vector<Message> messages(batches);
    std::size_t bytes = 0;
    for (Message& m : messages) {
      m.sender = PeerId{2};
      m.boot = m.number = 1;
      for (std::size_t i = 0; i < kBatch; ++i) m.updates.push_back(updates.next(SimTime{10s + i * 1us}));
    }
    std::vector<double> per_s, rounded_per_s;
    for (std::size_t round = 0; round < rounds; ++round) {
      std::vector<Bytes> sent(batches);
      const double s = seconds_of([&] {
        for (std::size_t i = 0; i < batches; ++i) sent[i] = encode(messages[i]);
      });
      std::vector<UpdateRecord> rounded;
      rounded.reserve(batches * kBatch);
      const double rounding_s = seconds_of([&] {
        for (const Message& m : messages) {
          for (const UpdateRecord& u : m.updates) rounded.push_back(quantised(u, kRounded));
        }
      });
      per_s.push_back(static_cast<double>(batches * kBatch) / s);
      rounded_per_s.push_back(static_cast<double>(batches * kBatch) / (s + rounding_s));
      if (round > 0) continue;
      std::uint64_t others = 0;
      for (std::size_t i = 0; i < batches; ++i) {
        bytes += sent[i].size();
        const auto decoded = decode(sent[i], SimTime{10s});
        const bool all = decoded && decoded->updates.size() == kBatch;
        for (std::size_t k = 0; k < kBatch; ++k) {
          others += !all || !same_record(decoded->updates[k], messages[i].updates[k]);
        }
      }
      wrong("records that are not decoded as they were encoded", others);
    }
    figure("encode_records_per_s", per_s, "records/s", ">= 1000000", 1e6);
    figure("encode_records_per_s.rounded", rounded_per_s, "records/s", "", 0.0);
    figure("encode_records_per_s.size", {static_cast<double>(bytes) / static_cast<double>(batches * kBatch)},
           "bytes/record", "", 0.0);
  }

  void town(std::size_t own, bool best, bool headline) {
    const Duration warm = options_.quick ? 3s : own > 1000 ? 5s : 8s;
    const int seconds = options_.quick ? 2 : own > 1000 ? 3 : 10;
    Town town(own, best);
    town.run(warm, nullptr);
    Cost cost;
    for (int second = 0; second < seconds; ++second) {
      Cost one;
      town.run(warm + (second + 1) * 1s, &one);
      one.simulated_s = 1.0;
      cost.packets_s += one.packets_s;
      cost.ticks_s += one.ticks_s;
      cost.ghosts_s += one.ghosts_s;
      cost.updates += one.updates;
      cost.datagrams += one.datagrams;
      cost.simulated_s += 1.0;
      cost.shares.push_back(one.share());
    }
    const std::string models = best ? "best" : "order2", objects = std::to_string((1 + kOthers) * own);
    wrong(models + ' ' + objects + ": ghosts that differ from their owner's", town.differences());
    wrong(models + ' ' + objects + ": ghosts that are not what their update says", town.elsewhere());
    wrong(models + ' ' + objects + ": updates that were not applied", town.not_applied());
    wrong(models + ' ' + objects + ": ghosts that nobody told of", kOthers * own - town.told());
    wrong(models + ' ' + objects + ": the ghosts seen are no number", !std::isfinite(town.seen()));
    std::vector<double> ghost_ns;
    for (int i = 0; i < 5; ++i) ghost_ns.push_back(town.ghost_ns(options_.quick ? 2 : own > 1000 ? 10 : 60));

    const std::string name = models + '.' + objects;
    if (headline) {
      const std::string suffix = best ? "" : ".order2";
      figure("ghost_eval_ns" + suffix, ghost_ns, "ns", "<= 100", 100.0);
      figure("tick_share_of_core" + suffix, cost.shares, "of a core", "< 0.20", 0.20);
      figure("tick_share_of_core" + suffix + ".packets", {cost.packets_s / cost.simulated_s}, "of a core", "", 0.0);
      figure("tick_share_of_core" + suffix + ".ticks", {cost.ticks_s / cost.simulated_s}, "of a core", "", 0.0);
      figure("tick_share_of_core" + suffix + ".ghosts", {cost.ghosts_s / cost.simulated_s}, "of a core", "", 0.0);
      figure("tick_share_of_core" + suffix + ".updates", {static_cast<double>(cost.updates) / cost.simulated_s},
             "updates/s", "", 0.0);
    }
    figure("growth." + name + ".tick_share_of_core", cost.shares, "of a core", "", 0.0);
    figure("growth." + name + ".ghost_eval_ns", ghost_ns, "ns", "", 0.0);
    char row[200];
    std::snprintf(row, sizeof row, "%s,%s,%zu,%.6g,%.6g,%.6g,%.6g,%.1f,%.1f,%.3g\n", models.c_str(), objects.c_str(),
                  own, quartiles(cost.shares).median, cost.packets_s / cost.simulated_s,
                  cost.ticks_s / cost.simulated_s, cost.ghosts_s / cost.simulated_s,
                  static_cast<double>(cost.updates) / cost.simulated_s,
                  static_cast<double>(cost.datagrams) / cost.simulated_s, quartiles(ghost_ns).median);
    csv_ += row;
    const double n = static_cast<double>((1 + kOthers) * own);
    Curves& curves = best ? best_ : order2_;
    curves.share.push_back({n, quartiles(cost.shares).median});
    curves.ghost_ns.push_back({n, quartiles(ghost_ns).median});
  }

  [[nodiscard]] std::vector<Chart> charts() const {
    return {{"share of a core at 60 Hz, an eleventh of the objects own",
             {"objects", true, false},
             {"of a core", true, false},
             {{"configs/best.toml", best_.share}, {"second order", order2_.share}}},
            {"one ghost",
             {"objects", true, false},
             {"ns", false, true},
             {{"configs/best.toml", best_.ghost_ns}, {"second order", order2_.ghost_ns}}}};
  }

  struct Curves {
    std::vector<report::Point> share, ghost_ns;
  };

  Options options_;
  std::vector<Figure> figures_;
  Curves best_, order2_;
  std::string csv_ =
      "models,objects,own,share_of_core,packets,ticks,ghosts,updates_in_per_s,datagrams_in_per_s,ghost_eval_ns\n";
  bool right_ = true;
};

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) {
  using namespace peerd::bench;
  return run_main(argc, argv, [](const Options& options) { return Bench(options).run(); });
}
