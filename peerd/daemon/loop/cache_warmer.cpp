#include "peerd/daemon/loop/cache_warmer.hpp"

#include <string>
#include <utility>
#include <variant>

#include <boost/asio/ip/address.hpp>

#include "core/scene/reader.hpp"
#include "peerd/net/os/udp_socket.hpp"

namespace peerd {
namespace {

constexpr std::array<const char*, 2> kObjects{"A", "B"};
constexpr const char* kWorld = "#VRML V2.0 utf8\nDEF A Transform { }\nDEF B Transform { }\n";
constexpr RegionId kRegion{0};

// Longer than the period of ticks, and not a multiple of it, so that an update is due in each run.
constexpr Duration kStep = std::chrono::milliseconds(50) + std::chrono::nanoseconds(17);
// Farther than any threshold of a scene [m].
constexpr double kStride_m = 1e3;
// The time until the two peers share a session and send hellos at the settled rate.
constexpr Duration kSettledAfter = std::chrono::seconds(8);

std::unique_ptr<const SharedWorld> make_world() {
  auto shared = std::make_unique<SharedWorld>();
  shared->world.scene = read_world(kWorld).scene.value();
  shared->model = replication::make_world_model(shared->world.scene);
  return shared;
}

std::unique_ptr<PeerNode> make_node(std::size_t number, const replication::PublishPolicy& policy,
                                    const SharedWorld& shared) {
  config::PeerSettings settings;
  settings.name = kObjects[number];
  settings.id = static_cast<std::uint32_t>(number + 1);
  config::ReplicationSettings replication;
  replication.policy = policy;
  const ObjectId object = shared.world.scene.find(kObjects[number]).value();
  config::PeerObjects objects;
  objects.owned = {object};
  objects.outside.emplace(kObjects[number], object);
  PeerNode::Options options;
  options.keep_log = false;
  return PeerNode::make(settings, replication, shared, std::move(objects), std::move(options));
}

}  // namespace

std::expected<std::unique_ptr<CacheWarmer>, net::NetError> CacheWarmer::make(replication::PublishPolicy policy,
                                                                             std::uint64_t runs_per_session) {
  policy.bytes_per_s.reset();
  if (policy.error_threshold_m >= kStride_m) policy.error_threshold_m.reset();
  std::unique_ptr<CacheWarmer> made(new CacheWarmer(policy, runs_per_session));
  net::MulticastOptions options;
  options.interface = "lo";
  options.groups.base = boost::asio::ip::make_address("239.192.80.0");
  options.ttl = 0;
  options.any_port = true;
  auto socket = net::MulticastSocket::open(made->io_, made->clock_, options);
  if (!socket) return std::unexpected(socket.error());
  made->socket_ = *std::move(socket);
  if (auto joined = made->socket_->join(kRegion); !joined) return std::unexpected(joined.error());
  CacheWarmer& r = *made;
  r.socket_->on_receive([&r](const net::Arrival& arrival) {
    for (const auto& node : r.nodes_) node->on_packet(r.now_, arrival.region, arrival.datagram);  // each drops its own
  });
  r.begin();
  r.run();
  if (r.updates_received() == 0) {
    return net::failure(net::NetError::Kind::kNoMulticast,
                        "multicast sent over \"lo\" does not come back (a firewall?)");
  }
  return made;
}

CacheWarmer::CacheWarmer(const replication::PublishPolicy& policy, std::uint64_t runs_per_session)
    : policy_(policy), runs_per_session_(runs_per_session), shared_(make_world()) {}

void CacheWarmer::begin() {
  runs_ = 0;
  ++sessions_;
  now_ = HostTime{};
  for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i] = make_node(i, policy_, *shared_);
  while (now_.time_since_epoch() < kSettledAfter) {
    now_ += kStep;
    for (const auto& node : nodes_) {
      node->on_tick(now_);
      send_all(*node);
    }
  }
}

void CacheWarmer::run() {
  if (runs_ == runs_per_session_) begin();
  now_ += kStep;
  const std::uint64_t turn = runs_ / nodes_.size(), sender = runs_ % nodes_.size();
  pose_.object = kObjects[sender];
  pose_.pose.position = {kStride_m * static_cast<double>((turn + 1) % 2), 0.0, 0.0};
  pose_.pose.jump = true;
  (void)nodes_[sender]->on_poses(now_, Duration{0}, {&pose_, 1});
  send_all(*nodes_[sender]);
  ++runs_;
}

std::uint64_t CacheWarmer::updates_received() const {
  return nodes_[0]->peer().counters().updates_in + nodes_[1]->peer().counters().updates_in;
}

void CacheWarmer::send_all(PeerNode& node) {
  bool sent = false;
  while (const auto out = node.poll_output()) {
    const auto* send = std::get_if<replication::Send>(&*out);
    if (send == nullptr) continue;
    socket_->send(send->region, send->datagram);
    sent = true;
  }
  while (node.poll_feed_notice()) {
  }
  if (!sent) return;
  socket_->flush();
  socket_->receive_pending();
}

}  // namespace peerd
