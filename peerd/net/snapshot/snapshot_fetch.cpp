#include "peerd/net/snapshot/snapshot_fetch.hpp"

#include <algorithm>
#include <cassert>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "peerd/net/greeting/address_text.hpp"
#include "peerd/net/snapshot/framed_stream.hpp"
#include "peerd/net/snapshot/parts.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::snapshot {
namespace {

namespace asio = boost::asio;
using replication::AuthorId;
using replication::LogLength;
using replication::OperationRange;

// A connection that fails is made again after this, until the fetch as a whole fails.
constexpr std::chrono::milliseconds kConnectedAgainAfter{500};
// Another peer is waited for so long, to compare what it has; without one nothing is compared.
constexpr Duration kComparedWithin = std::chrono::seconds(2);
// The largest world that a joining peer accepts [bytes]. A forger may pack nonsense into very few bytes, so a joining
// peer also holds no more than kUnpackedFree_bytes and kUnpackedTimes as many bytes as have come. Texts are packed to a
// twentieth.
constexpr std::uint64_t kSnapshotMax_bytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kUnpackedFree_bytes = std::uint64_t{64} << 20, kUnpackedTimes = 64;
// The time for which a joining peer waits, after the first offer, for the offers of other peers. Then it takes the
// world that most addresses offer.
constexpr Duration kOffersWithin = std::chrono::seconds(1);
// The number of connections in a row that a peer may close without a frame in the session's key. Then it is given up.
constexpr int kUnprovenTries = 4;

class Fetch {
 public:
  Fetch(const std::vector<Provider>& providers, std::uint64_t session, const FetchOptions& options)
      : asked_session_(session),
        session_(session),
        options_(options),
        patience_(io_),
        deadline_(io_),
        offers_due_(io_) {
    for (const Provider& provider : providers) {
      if (peers_.size() < options.providers) peers_.push_back(Peer{.provider = provider, .held = {}, .said = {}});
    }
  }

  std::expected<Snapshot, std::string> run() {
    if (peers_.empty()) return std::unexpected("no peer gives its world to joining peers");
    for (std::size_t peer = 0; peer < peers_.size(); ++peer) connect_all(peer);
    be_patient();
    io_.run();
    if (!error_.empty()) return std::unexpected(error_);
    return std::move(snapshot_);
  }

 private:
  struct Peer {
    Provider provider;
    std::optional<Offer> offer{};            // that it has made; whether it counts is to be decided
    std::map<AuthorId, std::uint64_t> held;  // lengths, where it offers the chosen world; else empty
    std::uint64_t received_bytes = 0;        // of its replies, as they came
    bool is_asked_for_offer = false;
    bool is_asked_for_digests = false;
    bool has_compared = false;  // its digests of what others gave are here
    bool is_of_use = true;
    bool takes_no_proof = false;  // an older peer, which has answered a hello without one
    int unproven = 0;             // how often in a row it has closed a connection before it said anything in the key
    std::set<std::string> said;   // notes about it
  };
  struct Connection {
    std::size_t peer;
    std::shared_ptr<FramedStream> stream;
    int attempt = 0;  // Peer::unproven as it was
    FramedStream::Proof proof = FramedStream::Proof::kWith;
    bool is_connected = false, asks_for_offer = false;
    bool has_provided = false, asks_for_digests = false;
    std::optional<OperationRange> awaits;
    std::set<OperationRange> asked;
  };
  using ConnectionPtr = std::shared_ptr<Connection>;

  // A peer that offers another world than the chosen one is kept in reserve, without connections.
  [[nodiscard]] bool is_in_reserve(std::size_t peer) const {
    return has_chosen_ && peers_[peer].offer && peers_[peer].held.empty();
  }

  // All connections begin at once, beside the offers: each takes a round trip, too.
  void connect_all(std::size_t peer) {
    const std::size_t share = std::max<std::size_t>(1, options_.connections / peers_.size());
    for (std::size_t i = 0; i < share; ++i) connect(peer);
  }

  void connect(std::size_t peer) {
    if (over_ || !peers_[peer].is_of_use || is_in_reserve(peer)) return;
    // Older peers take no proof. Whether this is one shows by turns.
    const bool has_proof = !peers_[peer].takes_no_proof && peers_[peer].unproven % 2 == 0;
    const auto proof = has_proof ? FramedStream::Proof::kWith : FramedStream::Proof::kWithout;
    const auto connection = std::make_shared<Connection>(Connection{
        .peer = peer, .stream = nullptr, .attempt = peers_[peer].unproven, .proof = proof, .awaits = {}, .asked = {}});
    connection->stream = std::make_shared<FramedStream>(
        FramedStream::Socket(io_), kReplyMax_bytes, options_.patience,
        [this, weak = std::weak_ptr(connection)](const std::string& why) {
          if (const auto failed = weak.lock()) on_failure(failed, why);
        },
        seal());
    connections_.insert(connection);
    connection->stream->connect(
        peers_[peer].provider.at,
        [this, connection] {
          connection->is_connected = true;
          ask_next(connection);
        },
        proof);
  }

  [[nodiscard]] std::optional<seal::StreamSeal> seal() const {
    if (!options_.key) return std::nullopt;
    return seal::StreamSeal(*options_.key, seal::StreamSeal::End::kClient);
  }

  void ask(const ConnectionPtr& connection, Request request, std::function<void(Reply)> on_reply) {
    connection->stream->write(encode(request), [this, connection, on_reply = std::move(on_reply)] {
      connection->stream->read([this, connection, on_reply](const std::string& frame) {
        if (over_) return;
        Peer& peer = peers_[connection->peer];
        peer.received_bytes += frame.size();
        peer.unproven = 0;
        peer.takes_no_proof = peer.takes_no_proof || connection->proof == FramedStream::Proof::kWithout;
        auto reply = decode_reply(frame);
        if (!reply && !options_.key && frame.size() == seal::StreamSeal::kHello_bytes) {
          return give_up(connection, "it is sealed, and begins with a key: leave out --open");
        }
        if (!reply) return on_failure(connection, reply.error());
        if (const auto* refusal = std::get_if<Refusal>(&*reply)) return give_up(connection, refusal->why);
        on_reply(*std::move(reply));
      });
    });
  }

  // Asks a connection that is asked for nothing at present for what is needed next.
  void ask_next(const ConnectionPtr& connection) {
    const bool is_asked = connection->awaits || connection->asks_for_offer || connection->asks_for_digests;
    if (over_ || is_asked || !connection->is_connected) return;
    Peer& peer = peers_[connection->peer];
    if (!peer.held.empty()) {
      ask_for_part(connection);
    } else if (!peer.is_asked_for_offer && !peer.offer) {
      peer.is_asked_for_offer = connection->asks_for_offer = true;
      ask_for_offer(connection);
    }
  }

  void ask_for_offer(const ConnectionPtr& connection) {
    ask(connection, {asked_session_, OfferRequest{}}, [this, connection](Reply reply) {
      connection->asks_for_offer = false;
      auto* offer = std::get_if<Offer>(&reply);
      if (offer == nullptr) return on_failure(connection, "it answers something else");
      take_offer(connection, std::move(*offer));
    });
  }

  void take_offer(const ConnectionPtr& connection, Offer offer) {
    Peer& peer = peers_[connection->peer];
    if (offer.protocol != replication::kProtocolVersion) {
      return give_up(connection, "it speaks version " + std::to_string(offer.protocol) +
                                     " of the protocol, this program " + std::to_string(replication::kProtocolVersion));
    }
    if (asked_session_ != 0 && offer.session != asked_session_) {
      return give_up(connection, "it offers the world of another session");
    }
    std::uint64_t bytes = offer.archive_bytes;
    for (const LogLength& log : offer.logs) bytes = std::min(kSnapshotMax_bytes + 1, bytes + log.bytes);
    if (bytes > kSnapshotMax_bytes) return give_up(connection, "its world is larger than 1 GiB");
    peer.offer = std::move(offer);
    if (!has_chosen_) {
      be_patient();
      if (std::ranges::all_of(peers_, [](const Peer& each) { return !each.is_of_use || each.offer; })) return choose();
      if (!std::exchange(awaits_offers_, true)) {
        offers_due_.expires_after(kOffersWithin);
        offers_due_.async_wait([this](const boost::system::error_code& cancelled) {
          if (!cancelled) choose();
        });
      }
      return;
    }
    accept_offer(connection->peer);
    if (compares_) return ask_for_digests();
    plan();
    be_patient();
    ask_on_all();
  }

  // Takes the world that most addresses offer; of two that as many do, the one that was offered by the earlier
  // provider. A single computer may answer for many peers.
  void choose() {
    awaits_offers_ = false;
    if (over_ || has_chosen_) return;
    std::map<std::size_t, std::set<asio::ip::address>> addresses;  // by the first peer that offers it
    for (std::size_t peer = 0; peer < peers_.size(); ++peer) {
      if (!peers_[peer].is_of_use || !peers_[peer].offer) continue;
      const auto same = std::ranges::find_if(addresses, [&](const auto& each) {
        return difference(*peers_[each.first].offer, *peers_[peer].offer).empty();
      });
      addresses[same == addresses.end() ? peer : same->first].insert(peers_[peer].provider.at.address());
    }
    if (addresses.empty()) return;
    take_as_first(std::ranges::max_element(addresses, {}, [](const auto& each) { return each.second.size(); })->first);
    for (std::size_t peer = 0; peer < peers_.size(); ++peer) {
      if (peers_[peer].offer && peers_[peer].is_of_use) accept_offer(peer);
    }
    plan();
    be_patient();
    ask_on_all();
  }

  void take_as_first(std::size_t peer) {
    has_chosen_ = true;
    first_ = peer;
    session_ = peers_[peer].offer->session;
    snapshot_.provided_by = peers_[peer].provider.name;
    snapshot_.offer = *peers_[peer].offer;
  }

  // How a world that a peer offers differs from the chosen one, for people; empty: it does not.
  [[nodiscard]] static std::string_view difference(const Offer& offered, const Offer& chosen) {
    if (offered.session != chosen.session || offered.genesis != chosen.genesis || offered.world != chosen.world) {
      return "it offers another world than most";
    }
    if (offered.archive_digest != chosen.archive_digest || offered.archive_bytes != chosen.archive_bytes) {
      return "it has packed the world's files in another way";
    }
    if (offered.settings != chosen.settings) return "its world has other settings than that of most";
    if (offered.line != chosen.line) return "its edits are of another line of descent than those of most";
    return "";
  }

  // Once it is known which world it is.
  void accept_offer(std::size_t index) {
    Peer& peer = peers_[index];
    if (const auto differs = difference(*peer.offer, snapshot_.offer); !differs.empty()) {
      drop_all(index);
      return note(index, std::string(differs));
    }
    peer.held = {{replication::kNoAuthor, peer.offer->archive_bytes}};
    for (const LogLength& log : peer.offer->logs) peer.held[log.author] = log.bytes;
    const bool was_in_reserve = std::ranges::none_of(connections_, [&](const auto& c) { return c->peer == index; });
    if (was_in_reserve) connect_all(index);
  }

  // Plans what to fetch of the chosen world. Called again when another peer offers that world, and when one is given
  // up.
  void plan() {
    snapshot_.offer.logs = logs_to_get();
    parts_.plan(snapshot_.offer.archive_bytes, snapshot_.offer.logs);
    for (const ConnectionPtr& each : connections_) each->asked.clear();
    be_quick();
  }

  // The logs to fetch. If two addresses or more offer the chosen world, a log counts only if two of them offer it, and
  // only as much of it as two of them have: no single member can make a joining peer fetch what it has invented. The
  // session itself brings the rest.
  [[nodiscard]] std::vector<LogLength> logs_to_get() const {
    std::set<asio::ip::address> addresses;
    std::map<AuthorId, std::map<asio::ip::address, std::uint64_t>> lengths;
    for (const Peer& peer : peers_) {
      if (peer.held.empty()) continue;
      addresses.insert(peer.provider.at.address());
      for (const auto& [author, bytes] : peer.held) {
        std::uint64_t& longest = lengths[author][peer.provider.at.address()];
        longest = std::max(longest, bytes);
      }
    }
    if (addresses.size() < 2) return peers_[first_].offer->logs;
    lengths.erase(replication::kNoAuthor);
    std::vector<LogLength> logs;
    for (const auto& [author, of_addresses] : lengths) {
      std::vector<std::uint64_t> longest;
      for (const auto& [address, bytes] : of_addresses) longest.push_back(bytes);
      std::ranges::sort(longest, std::greater{});
      if (longest.size() > 1) logs.push_back({author, longest[1]});
    }
    return logs;
  }

  void ask_for_part(const ConnectionPtr& connection) {
    if (parts_.are_there()) return compare();
    connection->awaits = parts_.next(peers_[connection->peer].held, connection->asked);
    if (!connection->awaits) return;  // all that it has is under way
    ask(connection, {session_, PartRequest{*connection->awaits}}, [this, connection](const Reply& reply) {
      const OperationRange asked = *std::exchange(connection->awaits, std::nullopt);
      const auto* part = std::get_if<Part>(&reply);
      if (part == nullptr || !parts_.take(asked, part->bytes, connection->peer)) {
        parts_.give_back(asked);
        return give_up(connection, "it answers something else");
      }
      const std::uint64_t free_bytes = kUnpackedFree_bytes / peers_.size();
      if (parts_.given_bytes(connection->peer) >
          free_bytes + kUnpackedTimes * peers_[connection->peer].received_bytes) {
        return give_up(connection, "it packs its world as only nonsense is packed");
      }
      be_patient();
      connection->has_provided = true;
      ask_on_all();
    });
  }

  void ask_on_all() {
    for (const ConnectionPtr& each : std::set(connections_)) {
      ask_next(each);
    }
  }

  // Everything is here. Peers are asked whether they have the same.
  void compare() {
    if (compares_) return ask_for_digests();
    if (digest(parts_.content(replication::kNoAuthor)) != snapshot_.offer.archive_digest) return on_other_archive();
    compares_ = true;
    be_patient();
    ask_for_digests();
  }

  // It is not known which of those that have given the archive has given something else. All of them go where others
  // have the world, too.
  void on_other_archive() {
    const std::set<std::size_t> givers = parts_.givers(replication::kNoAuthor);
    bool are_others = false;
    for (std::size_t peer = 0; peer < peers_.size(); ++peer) {
      are_others = are_others || (!peers_[peer].held.empty() && !givers.contains(peer));
    }
    if (!are_others) return end("what came is not the archive that " + snapshot_.provided_by + " has offered");
    parts_.drop_archive();
    for (const std::size_t peer : givers) give_up(peer, "what came from it and others is not the archive");
  }

  // A log that one peer has given is compared with another one; one that several have given, with each of two.
  void ask_for_digests() {
    if (std::ranges::none_of(connections_, [&](const ConnectionPtr& each) { return !peers_[each->peer].has_compared; }))
      return end("");  // there is nobody left to ask
    for (const ConnectionPtr& each : std::set(connections_)) {
      const Peer& peer = peers_[each->peer];
      const bool is_idle = each->is_connected && !each->awaits && !each->asks_for_offer && !each->asks_for_digests;
      if (over_ || !is_idle || peer.held.empty() || peer.is_asked_for_digests) continue;
      ask_for_digests(each);
    }
  }

  void ask_for_digests(const ConnectionPtr& connection) {
    Peer& peer = peers_[connection->peer];
    peer.is_asked_for_digests = true;
    DigestRequest request;
    for (const LogLength& log : snapshot_.offer.logs) {
      const auto held = peer.held.find(log.author);
      const bool is_others = parts_.givers(log.author) != std::set{connection->peer};
      if (is_others && held != peer.held.end()) request.logs.push_back({log.author, std::min(log.bytes, held->second)});
    }
    if (request.logs.empty()) return take_digests(connection, request, {});
    connection->asks_for_digests = true;
    ask(connection, {session_, request}, [this, connection, request](const Reply& reply) {
      connection->asks_for_digests = false;
      const auto* digests = std::get_if<Digests>(&reply);
      if (digests == nullptr || digests->digests.size() != request.logs.size()) {
        return give_up(connection, "it answers something else");
      }
      take_digests(connection, request, *digests);
    });
  }

  void take_digests(const ConnectionPtr& connection, const DigestRequest& asked, const Digests& got) {
    Peer& peer = peers_[connection->peer];
    for (std::size_t i = 0; i < asked.logs.size(); ++i) {
      const auto& [author, bytes] = asked.logs[i];
      if (got.digests[i] == digest(std::string_view(parts_.content(author)).substr(0, bytes))) continue;
      std::set<std::size_t> givers = parts_.givers(author);
      givers.erase(connection->peer);
      differences_.emplace(author, peers_[*givers.begin()].provider.name + " and " + peer.provider.name);
    }
    peer.has_compared = true;
    if (connection->peer != first_) snapshot_.checked_with = peer.provider.name;
    if (is_compared()) return end("");
    ask_for_digests();
  }

  // Whether each log has been compared with a peer that has not given it, or with two.
  [[nodiscard]] bool is_compared() {
    if (std::ranges::count_if(peers_, &Peer::has_compared) > 1) return true;
    const auto one = std::ranges::find_if(peers_, &Peer::has_compared);
    if (one == peers_.end()) return false;
    const auto peer = static_cast<std::size_t>(one - peers_.begin());
    return peer != first_ && std::ranges::none_of(snapshot_.offer.logs, [&](const LogLength& log) {
             return parts_.givers(log.author).contains(peer);
           });
  }

  void on_failure(const ConnectionPtr& connection, const std::string& why) {
    Peer& peer = peers_[connection->peer];
    if (connection->stream->is_open_there()) return give_up(connection, "it is open, and does not have the key");
    if (connection->stream->refused() == FramedStream::Refused::kOtherKey) {
      return give_up(connection, "it has another key; --key FILE says one");
    }
    const bool is_full = connection->stream->refused() == FramedStream::Refused::kNoPlace;
    const bool is_asked = connection->awaits || connection->asks_for_offer || connection->asks_for_digests;
    // Its other connections of the same attempt fail likewise, and count once. One that was asked for nothing is closed
    // soon by any peer.
    if (is_asked && connection->stream->is_unproven() && !is_full && connection->attempt == peer.unproven &&
        ++peer.unproven >= kUnprovenTries) {
      return give_up(connection,
                     why + ", as who has another key does, or no place for who joins; --key FILE says a key");
    }
    drop(connection);
    if (is_asked || !connection->is_connected) {
      note(connection->peer, is_full ? "it has no place for more who join" : why);
    }
    if (compares_) return ask_for_digests();
    const auto again = std::make_shared<asio::steady_timer>(io_, kConnectedAgainAfter);
    again->async_wait([this, again, peer = connection->peer](const boost::system::error_code&) { connect(peer); });
    ask_on_all();
  }

  // The peer is of no use: it is not asked again.
  void give_up(const ConnectionPtr& connection, const std::string& why) { give_up(connection->peer, why); }
  void give_up(std::size_t peer, const std::string& why) {
    if (over_ || !std::exchange(peers_[peer].is_of_use, false)) return;
    drop_all(peer);
    note(peer, why);
    if (compares_) return ask_for_digests();
    if (std::ranges::none_of(peers_, &Peer::is_of_use)) return end(last_failure_);
    if (!std::exchange(peers_[peer].held, {}).empty()) go_on_without(peer);
    if (!has_chosen_ && std::ranges::all_of(peers_, [](const Peer& p) { return !p.is_of_use || p.offer; })) choose();
    ask_on_all();
  }

  // Fetches from others what that peer has given. If nobody else has the chosen world, another one is chosen.
  void go_on_without(std::size_t peer) {
    parts_.drop(peer);
    const auto next = std::ranges::find_if(peers_, [](const Peer& each) { return !each.held.empty(); });
    if (next == peers_.end()) {
      has_chosen_ = false;
      parts_ = {};
      choose();
    } else {
      if (peer == first_) take_as_first(static_cast<std::size_t>(next - peers_.begin()));
      plan();
    }
  }

  void drop_all(std::size_t peer) {
    for (const ConnectionPtr& each : std::set(connections_)) {
      if (each->peer == peer) drop(each);
    }
  }

  void drop(const ConnectionPtr& connection) {
    connection->stream->close();
    if (connection->asks_for_digests) peers_[connection->peer].is_asked_for_digests = false;
    if (connection->asks_for_offer) peers_[connection->peer].is_asked_for_offer = false;
    if (connection->awaits) parts_.give_back(*std::exchange(connection->awaits, std::nullopt));
    connections_.erase(connection);
  }

  void note(std::size_t peer, const std::string& why) {
    const Provider& asked = peers_[peer].provider;
    const asio::ip::udp::endpoint at(asked.at.address(), asked.at.port());  // as TCP's, written
    const std::string address = net::address_text(at);
    last_failure_ = (asked.name == address ? address : asked.name + " at " + address) + ": " + why;
    if (peers_[peer].said.insert(why).second) snapshot_.notes.push_back(last_failure_);
  }

  void be_patient() {
    patience_.expires_after(compares_ ? kComparedWithin : options_.patience);
    patience_.async_wait([this](const boost::system::error_code& cancelled) {
      if (cancelled) return;
      const std::string why = last_failure_.empty() ? "nothing came for too long" : last_failure_;
      end(compares_ ? "" : why);
    });
  }

  // The whole fetch ends in time, however often something comes.
  void be_quick() {
    std::uint64_t bytes = snapshot_.offer.archive_bytes;
    for (const LogLength& log : snapshot_.offer.logs) bytes += log.bytes;
    deadline_.expires_after(options_.patience +
                            from_seconds(static_cast<double>(bytes) / options_.slowest_bytes_per_s));
    deadline_.async_wait([this](const boost::system::error_code& cancelled) {
      if (cancelled || over_) return;
      if (compares_) return end("");
      if (has_chosen_) give_up(slowest(), "what it gives comes too slowly");
    });
  }

  // The peer with the chosen world that has given least of it.
  [[nodiscard]] std::size_t slowest() const {
    std::size_t slowest = first_;
    for (std::size_t peer = 0; peer < peers_.size(); ++peer) {
      const bool is_slower = peers_[peer].received_bytes < peers_[slowest].received_bytes;
      if (!peers_[peer].held.empty() && is_slower) slowest = peer;
    }
    return slowest;
  }

  // With an empty error it has succeeded.
  void end(std::string error) {
    if (std::exchange(over_, true)) return;
    error_ = std::move(error);
    if (error_.empty() && !differences_.empty()) {
      const auto& [author, peers] = *differences_.begin();
      error_ = peers + " have different operations of author " + std::to_string(author.value) +
               " at one place: one of them is damaged, or lies";
    }
    const auto gave = [](const ConnectionPtr& each) { return each->has_provided; };
    snapshot_.connections = static_cast<std::size_t>(std::ranges::count_if(connections_, gave));
    for (const ConnectionPtr& each : connections_) each->stream->close();
    connections_.clear();
    io_.stop();
    if (!error_.empty()) return;
    snapshot_.archive = std::move(parts_.content(replication::kNoAuthor));
    for (const LogLength& log : snapshot_.offer.logs) {
      const std::string& bytes = parts_.content(log.author);
      const auto* const first = reinterpret_cast<const std::byte*>(bytes.data());
      snapshot_.logs.push_back({log.author, 0, {first, first + bytes.size()}});
    }
  }

  std::uint64_t asked_session_, session_;  // the session that was asked for, 0 where none was; that of the chosen world
  FetchOptions options_;
  asio::io_context io_{1};
  asio::steady_timer patience_, deadline_, offers_due_;
  std::vector<Peer> peers_;
  std::set<ConnectionPtr> connections_;
  std::size_t first_ = 0;  // the peer that has made the offer
  Parts parts_;
  Snapshot snapshot_;
  std::map<AuthorId, std::string> differences_;  // the two peers
  std::string last_failure_, error_;
  bool awaits_offers_ = false, has_chosen_ = false, compares_ = false, over_ = false;
};

}  // namespace

std::expected<Snapshot, std::string> fetch_snapshot(const std::vector<Provider>& providers, std::uint64_t session,
                                                    const FetchOptions& options) {
  return Fetch(providers, session, options).run();
}

}  // namespace peerd::snapshot
