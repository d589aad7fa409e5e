#include "wire_codec.hpp"

#include <algorithm>
#include <random>

#include "peerd/net/seal/sealer.hpp"
#include "replication/peer/peer.hpp"
#include "replication/wire/codec.hpp"
#include "replication/wire/record.hpp"
#include "wire_objects.hpp"

namespace peerd::bench {
namespace {

using namespace replication;
using namespace std::chrono_literals;

constexpr Tolerance kRounded{0.05, 0.05};  // of a record in a batch
constexpr std::size_t kBatch = 40;

// Updates of objects that walk and drive, one object after the other. Those of one tick are of one instant: a peer
// advances its worlds to a few instants between two ticks, and later ones wait for the next tick.
class Updates {
 public:
  Updates(const Crowd& crowd, std::size_t objects) : crowd_(crowd), objects_(objects), rng_(7) {}

  UpdateRecord next(SimTime at) {
    UpdateRecord u;
    u.object = crowd_.object(made_ % objects_);
    u.sequence = static_cast<std::uint32_t>(1 + made_ / objects_);
    u.at = at;
    KinematicState& s = u.model.state;
    s.position = {up_to(500.0), up_to(20.0), up_to(500.0)};
    s.velocity = {up_to(10.0), 0.0, up_to(10.0)};
    s.acceleration = {up_to(2.0), 0.0, up_to(2.0)};
    s.orientation = quat_exp({0.0, up_to(3.0), 0.0});
    s.angular_velocity_body.y() = up_to(1.0);
    ++made_;
    return quantised(u, kRounded);
  }

 private:
  double up_to(double most) { return draw(rng_, -most, most); }

  const Crowd& crowd_;
  std::size_t objects_;
  std::mt19937_64 rng_;
  std::size_t made_ = 0;
};

bool same_record(const UpdateRecord& a, const UpdateRecord& b) {
  return a.object == b.object && a.sequence == b.sequence && a.at == b.at && a.model.kind == b.model.kind &&
         same_bits(a.model.state, b.model.state);
}

PeerConfig listener() {
  PeerConfig config;
  config.id = PeerId{1};
  config.world_hash = 1;
  return config;
}

// A peer alone, which receives updates of all objects from another one.
class Listener {
 public:
  Listener(std::size_t objects, Sealing sealing)
      : sealing_(sealing),
        crowd_(objects),
        peer_(listener(), *crowd_.model),
        updates_(crowd_, objects),
        last_(objects) {
    for (; now_ < HostTime{2s}; now_ += 100ms) peer_.on_tick(now_, {});
    Message m = blank();
    Hello& hello = m.hello.emplace();
    hello.session_tx = peer_.clock().to_session(now_);
    Introduction& introduction = hello.introduction.emplace();
    introduction.name = "peer2";
    introduction.world_hash = 1;
    for (int i = 0; i < 3; ++i) {  // by which each proves that it runs
      announce();
      now_ += 20ms;
    }
    knows_sender_ = peer_.on_packet(now_, kWholeScene, encode(m)).has_value();
  }

  // The time [s] that on_packet takes for so many datagrams, a second later.
  double hear(std::size_t datagrams, std::size_t batch) {
    now_ += 1s;
    announce();
    peer_.on_tick(now_, {});
    while (peer_.poll_output()) {
    }
    const SimTime at = peer_.clock().to_session(now_) - 10ms;
    std::vector<Bytes> sent;
    for (std::size_t d = 0; d < datagrams; ++d) {
      Message m = blank();
      for (std::size_t i = 0; i < batch; ++i) {
        m.updates.push_back(updates_.next(at));
        last_[m.updates.back().object.number - crowd_.first.number] = m.updates.back();
      }
      sent.push_back(encode(m));
      if (sealing_ != Sealing::kNone) {
        const auto sealed = sealer_.seal(now_, kWholeScene, sent.back(), sealing_ == Sealing::kSigned);
        sent.back().assign(sealed.begin(), sealed.end());
      }
    }
    updates_sent_ += datagrams * batch;
    return seconds_of([&] {
      for (const Bytes& datagram : sent) {
        if (sealing_ == Sealing::kNone) {
          (void)peer_.on_packet(now_, kWholeScene, datagram);
        } else if (const auto opened = opener_.open(now_, kWholeScene, datagram)) {
          (void)peer_.on_packet(now_, kWholeScene, opened->datagram);
        }
      }
    });
  }

  [[nodiscard]] std::vector<std::string> wrong() const {
    std::vector<std::string> all;
    if (!knows_sender_) all.emplace_back("a hello was refused");
    if (peer_.counters().updates_in != updates_sent_) all.emplace_back("updates were not applied");
    const SimTime t = peer_.clock().to_session(now_);
    for (const UpdateRecord& u : last_) {
      if (u.sequence > 0 && matches_update(peer_.ghost(u.object, t), u, t)) continue;
      all.emplace_back("a ghost is not what its update says");
      break;
    }
    return all;
  }

 private:
  void announce() {
    if (const auto due = sealer_.announcement_due(now_)) (void)opener_.hear(*due, now_);
    if (const auto due = opener_.announcement_due(now_)) (void)sealer_.hear(*due, now_);
  }
  Message blank() {
    Message m;
    m.sender = PeerId{2};
    m.incarnation = 1;
    m.number = ++number_;
    return m;
  }

  Sealing sealing_;
  keys::SymmetricKey key_ = keys::SymmetricKey::random();
  seal::Sealer sealer_{key_, {.peer = PeerId{2}, .identity = keys::Identity::random()}};
  seal::Sealer opener_{key_, {.peer = PeerId{1}, .identity = keys::Identity::random()}};
  Crowd crowd_;
  Peer peer_;
  Updates updates_;
  std::vector<UpdateRecord> last_;
  HostTime now_{0s};
  std::uint32_t number_ = 0;
  std::uint64_t updates_sent_ = 0;
  bool knows_sender_ = false;
};

}  // namespace

CodecRates decode_and_apply(std::size_t objects, std::size_t batch, bool quick, Sealing sealing) {
  const std::size_t rounds = quick ? 2 : 20;
  const std::size_t datagrams = quick ? 400 : batch == 1 && sealing != Sealing::kSigned ? 20'000 : 1'000;  // a round
  Listener listener(objects, sealing);
  (void)listener.hear((objects + kBatch - 1) / kBatch, kBatch);
  (void)listener.hear(datagrams, batch);
  CodecRates rates;
  for (std::size_t round = 0; round < rounds; ++round) {
    const double s = listener.hear(datagrams, batch);
    rates.datagrams_per_s.push_back(static_cast<double>(datagrams) / s);
    rates.records_per_s.push_back(static_cast<double>(datagrams * batch) / s);
  }
  rates.wrong = listener.wrong();
  return rates;
}

CodecRates encode_batches(std::size_t objects, bool quick) {
  const std::size_t batches = quick ? 10 : 500, rounds = quick ? 2 : 21;
  const Crowd crowd(objects);
  Updates updates(crowd, objects);
  std::vector<Message> messages(batches);
  for (Message& m : messages) {
    m.sender = PeerId{2};
    m.incarnation = m.number = 1;
    for (std::size_t i = 0; i < kBatch; ++i) m.updates.push_back(updates.next(SimTime{10s + i * 1us}));
  }
  CodecRates rates;
  std::vector<Bytes> sent(batches);
  const auto records = static_cast<double>(batches * kBatch);
  for (std::size_t round = 0; round < rounds; ++round) {
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
    rates.datagrams_per_s.push_back(static_cast<double>(batches) / s);
    rates.records_per_s.push_back(records / s);
    rates.rounded_per_s.push_back(records / (s + rounding_s));
  }
  for (std::size_t i = 0; i < batches; ++i) {
    rates.record_bytes += static_cast<double>(sent[i].size()) / records;
    const auto decoded = decode(sent[i], SimTime{10s});
    const bool same = decoded && std::ranges::equal(decoded->updates, messages[i].updates, same_record);
    if (!same && rates.wrong.empty()) rates.wrong.emplace_back("a record is not decoded as it was encoded");
  }
  return rates;
}

}  // namespace peerd::bench
