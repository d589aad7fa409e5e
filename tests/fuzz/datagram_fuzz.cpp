// Sends any datagrams to a peer in session: decode() accepts only valid messages, and the peer continues in bounded
// work, with finite ghosts, and sends only messages that others can decode.
//
// An input is a row of datagrams. Each follows two bytes of its length (low byte first) and one byte of the time that
// passes before it [10 ms, 6 bits] and of its region (2 bits above). The rest is the last datagram. Each input goes to
// a peer that cuts the scene into regions and to one that does not.
#include <cstdint>
#include <memory>
#include <span>

#include "core/scene/reader.hpp"
#include "replication/peer/peer.hpp"
#include "replication/wire/codec.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace peerd;
using fuzz::require;
using namespace peerd::replication;

// The world has an own ball between two walls, a cube that the datagrams may claim, and one without interests.
constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF BALL Transform { collisionResponse CollisionResponse { } velocityVector 2 0 0 children Shape { geometry Box { size 1 1 1 } } }
DEF LEFT Transform { translation -4 0 0 children Shape { geometry Box { size 1 9 9 } } }
DEF RIGHT Transform { translation 4 0 0 children Shape { geometry Box { size 1 9 9 } } }
DEF CUBE Transform { translation 0 3 0 collisionResponse CollisionResponse { } children Shape { geometry Box { size 1 1 1 } } }
DEF FREE Transform { translation 0 9 0 children Shape { geometry Box { size 1 1 1 } } }
CollisionInterest { objectPath "BALL" interests [ "LEFT" "RIGHT" "CUBE" ] collisionType 1 }
CollisionInterest { objectPath "CUBE" interests [ "LEFT" "RIGHT" "BALL" ] collisionType 1 }
)";
constexpr HostTime kBegin{std::chrono::seconds(1'000)};  // near the times of the saved inputs
constexpr int kDatagramsMax = 24;                        // in one input

struct World {
  Scene scene = read_world(kWorld).scene.value();
  std::unique_ptr<const WorldModel> model = make_world_model(scene);
};

class Driver {
 public:
  Driver(const World& world, bool cuts) : world_(world), peer_(config(world.scene, cuts), *world.model) {
    pass(std::chrono::milliseconds(1200));  // a peer that is alone founds a session
    require(peer_.clock().synchronised());
  }

  void pass(Duration d) {
    const HostTime until = now_ + d;
    for (int calls = 0;; ++calls) {
      require(calls < 1000);
      const HostTime next = std::max(now_, peer_.next_deadline());
      if (next > until) break;
      now_ = next;
      peer_.on_tick(now_, {});
      drain();
    }
    now_ = until;
  }

  void receive(RegionId region, std::span<const std::byte> datagram) {
    const SimTime near = peer_.clock().to_session(now_);
    const auto message = decode(datagram, near);
    const auto taken = peer_.on_packet(now_, region, datagram);
    require(message.has_value() || !taken.has_value());
    if (message) {
      for (const UpdateRecord& u : message->updates) check(u.model.state);
      const Bytes again = encode(*message);
      if (again.size() <= kDatagramMax_bytes) {
        const auto same = decode(again, near);
        require(same.has_value() && encode(*same) == again);
      }
    }
    drain();
  }

  void check_ghosts() const {
    for (const auto& [object, owner] : peer_.owners()) {
      require(object.number < world_.scene.instances.size() && owner.value != 0);
      check(peer_.ghost(object, peer_.clock().to_session(now_)));
    }
  }

 private:
  static PeerConfig config(const Scene& scene, bool cuts) {
    PeerConfig c;
    c.id = PeerId{2};
    c.name = "fuzzed";
    c.incarnation = 7;
    c.world_hash = 1;
    if (cuts) c.regions.cell_m = 4.0;
    c.owned = {{scene.find("BALL").value(), false}};
    return c;
  }

  static void check(const KinematicState& s) {
    require(s.position.allFinite() && s.velocity.allFinite() && s.acceleration.allFinite());
    require(std::abs(s.orientation.norm() - 1.0) < 1e-5);
  }

  void drain() {
    int outputs = 0;
    while (auto out = peer_.poll_output()) {
      require(++outputs < 100'000);
      if (const auto* send = std::get_if<Send>(&*out)) {
        require(send->datagram.size() <= kDatagramMax_bytes &&
                decode(send->datagram, peer_.clock().to_session(now_)).has_value());
      }
    }
  }

  const World& world_;
  HostTime now_ = kBegin;
  Peer peer_;
};

void run(std::span<const std::byte> rest, bool cuts) {
  static const World world;
  Driver driver(world, cuts);
  for (int i = 0; i < kDatagramsMax && rest.size() > 3; ++i) {
    const auto length = std::to_integer<std::size_t>(rest[0]) | std::to_integer<std::size_t>(rest[1]) << 8;
    const auto pause_and_region = std::to_integer<std::uint32_t>(rest[2]);
    rest = rest.subspan(3);
    driver.pass(std::chrono::milliseconds(10 * (pause_and_region & 63)));
    const auto datagram = rest.first(std::min(length, rest.size()));
    driver.receive(RegionId{pause_and_region >> 6}, datagram);
    rest = rest.subspan(datagram.size());
  }
  driver.pass(std::chrono::milliseconds(50));
  driver.check_ghosts();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  run(input, false);
  run(input, true);
  return 0;
}
