// Question: what do a ghost, a datagram, a tick and the way of an update cost a peer, and how does that grow with the
// number of objects?
//
// wire_bench [--quick] [--out DIR] [--commit NAME] [OWN..]: one peer runs an eleventh of all objects, driven at 60 Hz
// along sums of waves; ten others run a tenth of the rest each. One of the ten is a whole peer that dead-reckons its
// objects; the other nine say what it says of objects of their own, datagram by datagram, so that updates come as often
// as dead reckoning needs. Everything arrives after 20 ms. Models: as in configs/best.toml; `.order2`: the thesis's
// second order with the objects' own thresholds (0.5 m). No interests.
//
// Times are of the thread, so what else runs here doesn't count. tick_share_of_core: of 10,000 ghosts and 1,000 own
// objects, what on_packet, on_tick, draining the outputs and evaluating every ghost at every tick take of a simulated
// second. decode_apply_per_s, encode_records_per_s: wire_codec.hpp. bytes_over_dis, flock_received_over_aoi:
// wire_traffic.hpp. growth.OBJECTS.WHAT: the same with so many objects in the world. OWN: only ticks, with so many own
// objects; `loopback`: only how long an update is under way (loopback/), `traffic`: only bytes. Writes wire-growth.csv
// besides. Exit code 1: a ghost is not what its owner's update says or not, to the last bit, what its owner believes of
// it; not all that was sent was applied; a record is not decoded as it was encoded; an update did not come.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <random>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "bench/loopback/loopback.hpp"
#include "figures.hpp"
#include "replication/peer/peer.hpp"
#include "replication/wire/codec.hpp"
#include "simulated_run.hpp"
#include "wire_codec.hpp"
#include "wire_objects.hpp"
#include "wire_traffic.hpp"

namespace peerd::bench {
namespace {

using namespace replication;
using namespace std::chrono_literals;

constexpr std::uint32_t kOthers = 10;
constexpr Duration kLatency = 20ms, kFrame = Duration{1'000'000'000 / 60};

struct Cost {
  double packets_s = 0.0, ticks_s = 0.0, ghosts_s = 0.0;  // of simulated_s
  double simulated_s = 0.0, ghost_ns = 0.0;
  std::uint64_t datagrams = 0, updates = 0;
  std::vector<double> shares;  // second by second
  [[nodiscard]] double share() const { return (packets_s + ticks_s + ghosts_s) / simulated_s; }
};

// The measured peer, the whole sender among the others, and the peers that repeat the sender's datagrams.
class Town {
 public:
  Town(std::size_t own_count, const PublishPolicy& policy)
      : own_count_(own_count),
        crowd_((1 + kOthers) * own_count),
        measured_(config_of(1, object(0, 0), own_count_, policy), *crowd_.model),
        sender_(config_of(1 + kOthers, object(kOthers, 0), own_count_, policy), *crowd_.model) {
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

  // Counts the ghosts that differ between the two peers once nothing is under way.
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
  // The number of ghosts that are not where the last applied update puts them.
  [[nodiscard]] std::size_t elsewhere() const {
    const SimTime t = measured_.clock().to_session(now_);
    return static_cast<std::size_t>(std::ranges::count_if(last_updates_, [&](const UpdateRecord& update) {
      return update.sequence > 0 && !matches_update(measured_.ghost(update.object, t), update, t);
    }));
  }
  [[nodiscard]] std::uint64_t not_applied() const { return delivered_ - measured_.counters().updates_in; }
  [[nodiscard]] std::size_t updated_objects() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(last_updates_, [](const UpdateRecord& u) { return u.sequence > 0; }));
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

  // Block 0 holds the measured peer's objects, block k those of the peer 1 + k.
  [[nodiscard]] ObjectId object(std::size_t block, std::size_t i) const {
    return crowd_.object(block * own_count_ + i);
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
      if (last_updates_.size() <= u.object.number) last_updates_.resize(u.object.number + 1);
      UpdateRecord& last = last_updates_[u.object.number];
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
        return ObjectId{o.number - static_cast<std::uint32_t>((kOthers - k) * own_count_)};
      };
      m.sender = PeerId{1 + k};
      if (m.introduction() != nullptr) {
        for (ObjectId& o : m.hello->introduction->owned) o = shifted(o);
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
  std::vector<UpdateRecord> last_updates_;  // by object: the update that was delivered last
  std::uint64_t delivered_ = 0;
  double seen_ = 0.0;
};

class Bench : public Report {
 public:
  explicit Bench(const Options& options) : Report(options) {}

  int run() {
    const std::string only = options_.arguments.size() == 1 ? options_.arguments.front() : "";
    if (options_.arguments.empty() || only == "loopback") loopback();  // first: it forks, while this process is small
    if (options_.arguments.empty() || only == "traffic") traffic();
    if (only == "loopback" || only == "traffic") return write();
    const std::size_t headline = options_.quick ? 40 : 1000;
    std::vector<std::size_t> own_counts{10, 100, 1000, 10'000};
    if (options_.quick) own_counts = {10, headline};
    if (options_.arguments.empty()) {
      for (const std::size_t own : own_counts) codec(own * 10, own == headline);
    } else {
      own_counts.clear();
      for (const std::string& argument : options_.arguments) own_counts.push_back(std::stoul(argument));
    }
    for (const bool best : {true, false}) {
      for (const std::size_t own : own_counts) town(own, best, own == headline);
    }
    return write();
  }

 private:
  int write() { return finish() && write_beside(options_, "wire-growth.csv", csv()) ? 0 : 1; }
  void wrong(const std::string& what, std::uint64_t count) {
    if (count == 0) return;
    Report::wrong(what + ": " + std::to_string(count));
  }
  void figure(const std::string& name, const std::vector<double>& samples, const char* unit, const char* target = "",
              double target_value = 0.0) {
    const Quartiles q = quartiles(samples);
    const auto ratio = target_value > 0.0 ? std::optional(q.median / target_value) : std::nullopt;
    add_and_print({name, q.median, unit, target, ratio, q.low, q.high});
  }
  void growth(std::size_t objects, const std::string& what, const std::vector<double>& samples, const char* unit) {
    figure("growth." + std::to_string(objects) + '.' + what, samples, unit);
  }

  void loopback() {
    for (const LoopbackResult& result : {measure_loopback(options_.quick), measure_loopback_growth(options_.quick)}) {
      for (const std::string& what : result.wrong) wrong(what, 1);
      for (const Figure& f : result.figures) add_and_print(f);
    }
  }

  void traffic() {
    for (const Figure& f : wire_traffic(options_)) add_and_print(f);
  }

  void codec(std::size_t objects, bool headline) {
    for (const std::size_t batch : {1, 40}) {
      const CodecRates rates = decode_and_apply(objects, batch, options_.quick, Sealing::kNone);
      for (const std::string& what : rates.wrong) wrong(std::to_string(objects) + " objects: " + what, 1);
      const std::string name = batch == 1 ? "decode_apply_per_s" : "decode_apply_per_s.batch" + std::to_string(batch);
      growth(objects, name, rates.datagrams_per_s, "datagrams/s");
      if (!headline) continue;
      if (batch == 1) {
        figure(name, rates.datagrams_per_s, "datagrams/s", ">= 100000", 1e5);
        const CodecRates sealed = decode_and_apply(objects, batch, options_.quick, Sealing::kSealed);
        for (const std::string& what : sealed.wrong) wrong("sealed: " + what, 1);
        figure("open_" + name, sealed.datagrams_per_s, "datagrams/s", ">= 500000", 5e5);
        const CodecRates with_signatures = decode_and_apply(objects, batch, options_.quick, Sealing::kSigned);
        for (const std::string& what : with_signatures.wrong) wrong("signed: " + what, 1);
        figure("check_" + name, with_signatures.datagrams_per_s, "datagrams/s");
      } else {
        figure(name, rates.datagrams_per_s, "datagrams/s");
        figure(name + ".records", rates.records_per_s, "records/s");
      }
    }
    const CodecRates rates = encode_batches(objects, options_.quick);
    for (const std::string& what : rates.wrong) wrong(std::to_string(objects) + " objects: " + what, 1);
    growth(objects, "encode_records_per_s", rates.records_per_s, "records/s");
    if (!headline) return;
    figure("encode_records_per_s", rates.records_per_s, "records/s", ">= 1000000", 1e6);
    figure("encode_records_per_s.rounded", rates.rounded_per_s, "records/s");
    figure("encode_records_per_s.size", {rates.record_bytes}, "bytes/record");
  }

  void town(std::size_t own, bool best, bool headline) {
    const Duration warm = options_.quick ? 3s : own > 1000 ? 5s : 8s;
    const int seconds = options_.quick ? 2 : own > 1000 ? 3 : 10;
    Town town(own, best ? policy_in("best") : PublishPolicy{});
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
    const std::size_t objects = (1 + kOthers) * own;
    const std::string suffix = best ? "" : ".order2", of = std::to_string(objects) + " objects" + suffix;
    wrong(of + ": ghosts that differ from their owner's", town.differences());
    wrong(of + ": ghosts that are not what their update says", town.elsewhere());
    wrong(of + ": updates that were not applied", town.not_applied());
    wrong(of + ": ghosts without an update", kOthers * own - town.updated_objects());
    wrong(of + ": the ghosts seen are no number", !std::isfinite(town.seen()));
    std::vector<double> ghost_ns;
    for (int i = 0; i < 5; ++i) ghost_ns.push_back(town.ghost_ns(options_.quick ? 2 : own > 1000 ? 10 : 60));

    const std::string share = "tick_share_of_core" + suffix;
    const auto of_a_second = [&](double sum) { return std::vector{sum / cost.simulated_s}; };
    const std::tuple<std::string, std::vector<double>, const char*> parts[] = {
        {share + ".packets", of_a_second(cost.packets_s), "of a core"},
        {share + ".ticks", of_a_second(cost.ticks_s), "of a core"},
        {share + ".ghosts", of_a_second(cost.ghosts_s), "of a core"},
        {share + ".updates", of_a_second(static_cast<double>(cost.updates)), "updates/s"},
        {share + ".datagrams", of_a_second(static_cast<double>(cost.datagrams)), "datagrams/s"}};
    growth(objects, "ghost_eval_ns" + suffix, ghost_ns, "ns");
    growth(objects, share, cost.shares, "of a core");
    for (const auto& [name, value, unit] : parts) growth(objects, name, value, unit);
    if (!headline) return;
    figure("ghost_eval_ns" + suffix, ghost_ns, "ns", "<= 100", 100.0);
    figure(share, cost.shares, "of a core", "< 0.20", 0.20);
    for (const auto& [name, value, unit] : parts) figure(name, value, unit);
  }

  // The figures growth.OBJECTS.WHAT as a table of their own.
  [[nodiscard]] std::string csv() const {
    constexpr std::string_view kMark = "growth.";
    std::string text = "figure,objects,value,unit,low,high\n";
    for (const Figure& f : figures_) {
      if (!f.name.starts_with(kMark)) continue;
      const auto dot = f.name.find('.', kMark.size());
      const double objects = std::stod(f.name.substr(kMark.size(), dot - kMark.size()));
      char row[200];
      std::snprintf(row, sizeof row, "%s,%.0f,%.6g,%s,%.6g,%.6g\n", f.name.substr(dot + 1).c_str(), objects, f.value,
                    f.unit.c_str(), f.low, f.high);
      text += row;
    }
    return text;
  }
};

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) {
  using namespace peerd::bench;
  return run_main(argc, argv, [](const Options& options) { return Bench(options).run(); });
}
