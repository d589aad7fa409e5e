// Two whole peers as `peerd run` has them: PeerNode, Daemon, multicast over lo. Each moves objects by poses of a
// program outside. The ping puts one of its objects elsewhere; the pong, when it hears that, the one of its own that
// goes with it.
#include <cmath>
#include <fstream>
#include <random>
#include <stdexcept>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "bench/temporary_folder.hpp"
#include "peerd/daemon/loop/cache_warmer.hpp"
#include "peerd/daemon/loop/daemon.hpp"
#include "peerd/daemon/open/session_seal.hpp"
#include "peerd/net/seal/sealed_transport.hpp"
#include "peerd/net/transport/open_transport.hpp"
#include "peerd/net/transport/transport_options.hpp"
#include "ping_pong.hpp"

namespace peerd::bench {
namespace {

// An object is published once between two ticks, or with the next one. So each has its turn once in two ticks.
std::size_t objects_for(Pace pace) { return pace == Pace::kPingPong ? 2'000 : 34; }
// Longer than from one ping to the next: no peer sleeps.
constexpr std::chrono::microseconds kBusyPoll = 2 * kPingInterval;

std::string name_of(char side, std::size_t i) { return side + std::to_string(i); }

// The configuration of both, in a folder that is gone with the object.
class Session {
 public:
  Session(const Round& round, std::size_t objects)
      : busy_poll_us_(round.waits == Waits::kBusyPolling ? kBusyPoll.count() : 0),
        key_(round.sealed ? std::optional(keys::SymmetricKey::random()) : std::nullopt),
        moving_(objects_for(round.pace)),
        others_(std::max(objects / 2, moving_) - moving_) {
    std::string world = "#VRML V2.0 utf8\n", scenario = "world = \"w.wrl\"\n";
    for (const char side : {'a', 'b'}) {
      const std::string peer = std::string("[peer.") + side;
      std::string owns, motions;
      for (std::size_t i = 0; i < moving_; ++i) {
        world += "DEF " + name_of(side, i) + " Transform { }\n";
        owns += (i == 0 ? "\"" : ", \"") + name_of(side, i) + '"';
        motions += peer + ".motion." + name_of(side, i) + "]\noutside = true\n";
      }
      for (std::size_t i = 0; i < others_; ++i) {
        world += std::string("DEF s") + side + std::to_string(i) + " Transform { }\n";
      }
      if (others_ > 0) owns += std::string(", \"s") + side + "*\"";
      scenario += peer + "]\nid = " + (side == 'a' ? "1" : "2") + "\nowns = [" + owns + "]\n" + motions;
    }
    std::ofstream(folder_ / "w.wrl") << world;
    std::ofstream(folder_ / "s.toml") << scenario;
    port_ = static_cast<int>(20'000 + std::random_device()() % 12'000);
  }
  [[nodiscard]] std::size_t moving() const { return moving_; }  // of each side
  [[nodiscard]] std::size_t objects() const { return 2 * (moving_ + others_); }
  [[nodiscard]] const std::optional<keys::SymmetricKey>& key() const { return key_; }
  [[nodiscard]] config::Scenario read() const {
    config::ScenarioRequest request;
    request.file = folder_ / "s.toml";
    request.sets = {"transport.port=" + std::to_string(port_), "transport.interface=\"lo\"",
                    "transport.busy_poll_us=" + std::to_string(busy_poll_us_)};
    request.real = true;
    auto scenario = config::read_scenario(request);
    if (!scenario) throw std::runtime_error(scenario.error().text);
    return *std::move(scenario);
  }

 private:
  std::chrono::microseconds::rep busy_poll_us_;
  std::optional<keys::SymmetricKey> key_;  // none: it is open
  std::size_t moving_, others_;            // of each side
  TemporaryFolder folder_;
  int port_;
};

template <class T, class Error>
T value_of(std::expected<T, Error> result, const std::string& what) {
  if (!result) throw std::runtime_error(what);
  return *std::move(result);
}

// One of the two.
class Side {
 public:
  Side(const Session& session, char side)
      : own_(side),
        objects_(session.objects()),
        scenario_(session.read()),
        shared_(value_of(share_world(scenario_.world), "no world")),
        node_(make_node()),
        transport_(open(session.key())),
        daemon_(
            io_, *node_, *transport_, clock_, [](const LogLine&) {}, std::nullopt) {
    const config::RunSettings& run = scenario_.runs.front();
    const std::chrono::microseconds before_sleep(run.transport.busy_poll_us);
    if (before_sleep.count() > 0) {
      cache_warmer_ = value_of(CacheWarmer::make(run.replication.policy), "no cache warming");
    }
    daemon_.busy_poll(before_sleep, cache_warmer_.get());
    const Scene& scene = shared_->world.scene;
    for (std::size_t i = 0; i < session.moving(); ++i) {
      names_.push_back(name_of(side, i));
      others_.push_back(scene.find(name_of(side == 'a' ? 'b' : 'a', i)).value());
    }
  }

  // Puts its i-th object where the others have not seen it.
  void publish(std::size_t i) {
    pose_.object = names_[i % names_.size()];
    pose_.pose.position = place(i);
    pose_.pose.jump = true;
    daemon_.on_poses({&pose_, 1});
  }
  // Whether the other's i-th object is at its last place.
  [[nodiscard]] bool hears(std::size_t i) const {
    const replication::UpdateRecord* update = node_->peer().last_update_of(others_[i % others_.size()]);
    return update != nullptr && (update->model.state.position - place(i)).norm() < 0.01;
  }
  [[nodiscard]] bool ready() const {
    const auto& members = node_->peer().members().all();
    return node_->start() && members.size() == 1 && members.begin()->second.echo.echoes_us &&
           node_->peer().owners().size() == objects_;
  }
  [[nodiscard]] std::uint64_t lost() const {
    const net::TrafficCounters& c = transport_->counters();
    return c.in_queue_overflow + c.out_queue_full + c.in_errors + c.out_errors;
  }
  boost::asio::io_context& io() { return io_; }
  Daemon& daemon() { return daemon_; }

 private:
  // [m]; each turn of an object elsewhere than the one before, by more than any threshold.
  static Vec3 place(std::size_t i) { return {static_cast<double>(1 + i), 0.0, 0.0}; }

  std::unique_ptr<PeerNode> make_node() {
    const config::RunSettings& run = scenario_.runs.front();
    auto objects = config::resolve(run, shared_->world.scene);
    if (!objects) throw std::runtime_error(objects.error().text);
    const std::size_t number = own_ == 'a' ? 0 : 1;
    PeerNode::Options options;
    options.incarnation = static_cast<std::uint64_t>(clock_.now().time_since_epoch().count());
    options.wait_for = {{PeerId{1}, "1"}, {PeerId{2}, "2"}};
    options.keep_log = false;
    return PeerNode::make(run.peers[number], run.replication, *shared_, std::move((*objects)[number]),
                          std::move(options));
  }
  std::unique_ptr<net::Transport> open(const std::optional<keys::SymmetricKey>& key) {
    auto options = net::transport_options(scenario_.runs.front().transport, net::random_key());
    if (!options) throw std::runtime_error(options.error().text);
    options->use = net::MulticastUse::kAlways;
    auto opened = net::open_transport(io_, clock_, *options);
    if (!opened) throw std::runtime_error(opened.error().sentence);
    if (!key) return std::move(opened->transport);
    const seal::Sealer::Self self{.peer = PeerId{own_ == 'a' ? 1U : 2U}, .identity = keys::Identity::random()};
    return std::make_unique<seal::SealedTransport>(io_, clock_, std::move(opened->transport), *key, self, contents_of,
                                                   [](const std::string&) {});
  }

  char own_;
  std::size_t objects_;  // of both
  boost::asio::io_context io_{1};
  net::HostClock clock_;
  config::Scenario scenario_;
  std::unique_ptr<const SharedWorld> shared_;
  std::unique_ptr<PeerNode> node_;
  std::unique_ptr<net::Transport> transport_;
  std::unique_ptr<CacheWarmer> cache_warmer_;
  Daemon daemon_;
  std::vector<std::string> names_;  // of its own that move,
  std::vector<ObjectId> others_;    // .. and of the other's
  feed::FedPose pose_;
};

// Ends the loop when nothing has come for too long.
class Watch {
 public:
  explicit Watch(boost::asio::io_context& io) : timer_(io), io_(io) { check(); }
  void progress() { last_ = Clock::now(); }
  [[nodiscard]] bool gave_up() const { return gave_up_; }

 private:
  void check() {
    timer_.expires_after(std::chrono::milliseconds(500));
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (error) return;
      gave_up_ = Clock::now() - last_ > 2 * kPongWithin;
      if (gave_up_) return io_.stop();
      check();
    });
  }
  boost::asio::steady_timer timer_;
  boost::asio::io_context& io_;
  Clock::time_point last_ = Clock::now();
  bool gave_up_ = false;
};

void finish(Side& side, const Watch& watch, std::size_t done, std::size_t of) {
  if (watch.gave_up() || done != of) {
    throw std::runtime_error("only " + std::to_string(done) + " of " + std::to_string(of) + " updates came");
  }
  if (side.lost() > 0) throw std::runtime_error(std::to_string(side.lost()) + " datagrams were lost");
}

void ping(Side& side, Pace pace, Stamps& stamps) {
  Watch watch(side.io());
  boost::asio::steady_timer timer(side.io());
  std::size_t next = 0;  // to be published, or under way
  bool under_way = false;
  const auto send = [&] {
    under_way = true;
    stamps.published[next] = Clock::now();
    side.publish(next);
  };
  std::function<void()> schedule;
  auto due = Clock::now();
  schedule = [&] {
    due = std::max(due + kPingInterval, Clock::now());
    timer.expires_at(due);
    timer.async_wait([&](const boost::system::error_code& error) {
      if (error) return;
      side.ready() ? send() : schedule();
    });
  };
  side.daemon().on_received([&] {
    if (!under_way || !side.hears(next)) return;
    stamps.answered[next] = Clock::now();
    watch.progress();
    under_way = false;
    if (++next == stamps.pings) return side.io().stop();
    pace == Pace::kPingPong ? send() : schedule();
  });
  schedule();
  (void)side.daemon().run();
  finish(side, watch, next, stamps.pings);
}

void pong(Side& side, Stamps& stamps) {
  Watch watch(side.io());
  std::size_t next = 0;
  side.daemon().on_received([&] {
    if (next == stamps.pings || !side.hears(next)) return;
    stamps.heard[next] = Clock::now();
    watch.progress();
    side.publish(next);
    if (++next == stamps.pings) side.io().stop();
  });
  (void)side.daemon().run();
  finish(side, watch, next, stamps.pings);
}

}  // namespace

Latencies peers_round(const Round& round, std::size_t objects) {
  const Session session(round, objects);
  return ping_pong(
      round.pings, round.cores,
      [&](Stamps& stamps) {
        Side side(session, 'a');
        ping(side, round.pace, stamps);
      },
      [&](Stamps& stamps) {
        Side side(session, 'b');
        pong(side, stamps);
      });
}

}  // namespace peerd::bench
