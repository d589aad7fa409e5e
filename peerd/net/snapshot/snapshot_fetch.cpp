#include "peerd/net/snapshot/snapshot_fetch.hpp"

#include <algorithm>
#include <cassert>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "peerd/net/greeting/address_text.hpp"
#include "peerd/net/snapshot/framed_stream.hpp"
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
// A joining peer accepts no more of a world [bytes], so that a forger does not fill its memory. What it holds is
// besides at most kUnpackedFree_bytes and so many times as much as has come: texts are packed to a twentieth, nothing
// to less.
constexpr std::uint64_t kSnapshotMax_bytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kUnpackedFree_bytes = std::uint64_t{64} << 20, kUnpackedTimes = 64;
// Once the first offer has come, those of others are waited for so long: the archive that most addresses offer is
// taken.
constexpr Duration kOffersWithin = std::chrono::seconds(1);
// A peer that closes connections before it has said anything in the session's key, so often in a row, is of no use.
constexpr int kUnprovenTries = 4;

// The Parts that have to be got, of the archive and of each log, and which of them are there.
class Parts {
 public:
  void plan(const Offer& offer) {
    add(replication::kNoAuthor, offer.archive_bytes);
    for (const LogLength& log : offer.logs) add(log.author, log.bytes);
  }
  // The next part to ask a peer for that holds logs so long, over a connection that has `asked` for these already: a
  // part that no connection awaits, else one that a single other connection does, which may be slow.
  std::optional<OperationRange> next(const std::map<AuthorId, std::uint64_t>& held, std::set<OperationRange>& asked) {
    const auto fits = [&](const OperationRange& part) {
      const auto log = held.find(part.author);
      return log != held.end() && part.to <= log->second && !asked.contains(part);
    };
    auto found = std::ranges::find_if(unasked_, fits);
    if (found != unasked_.end()) {
      const OperationRange part = *found;
      unasked_.erase(found);
      awaited_.push_back({part, 1});
      asked.insert(part);
      return part;
    }
    const auto again =
        std::ranges::find_if(awaited_, [&](const Awaited& each) { return each.connections == 1 && fits(each.part); });
    if (again == awaited_.end()) return std::nullopt;
    ++again->connections;
    asked.insert(again->part);
    return again->part;
  }
  // False: the bytes, which that peer gives, are not what was asked for.
  bool take(const OperationRange& part, std::string_view bytes, std::size_t peer) {
    if (bytes.size() != part.to - part.from) return false;
    const auto awaited = std::ranges::find(awaited_, part, &Awaited::part);
    if (awaited == awaited_.end()) return true;  // another peer was faster
    awaited_.erase(awaited);
    content_[part.author].emplace(part.from, bytes);
    held_bytes_ += bytes.size();
    givers_[part.author].insert(peer);
    return true;
  }
  // A connection has failed that was asked for the part.
  void give_back(const OperationRange& part) {
    const auto awaited = std::ranges::find(awaited_, part, &Awaited::part);
    if (awaited == awaited_.end() || --awaited->connections > 0) return;
    awaited_.erase(awaited);
    unasked_.push_front(part);
  }
  [[nodiscard]] bool are_there() const { return unasked_.empty() && awaited_.empty(); }
  [[nodiscard]] std::uint64_t held_bytes() const { return held_bytes_; }
  // A log, or the archive, all of which is there. From then on it is one text.
  [[nodiscard]] std::string& content(AuthorId author) {
    std::map<std::uint64_t, std::string>& parts = content_[author];
    if (parts.size() != 1) {
      std::string whole;
      while (!parts.empty()) whole += parts.extract(parts.begin()).mapped();
      parts.emplace(0, std::move(whole));
    }
    return parts.begin()->second;
  }
  // The peers that have given parts of a log.
  [[nodiscard]] const std::set<std::size_t>& givers(AuthorId author) { return givers_[author]; }

 private:
  void add(AuthorId author, std::uint64_t bytes) {
    for (std::uint64_t from = 0; from < bytes; from += kPartMax_bytes) {
      unasked_.push_back({author, from, std::min<std::uint64_t>(bytes, from + kPartMax_bytes)});
    }
  }

  std::deque<OperationRange> unasked_;
  struct Awaited {
    OperationRange part;
    std::size_t connections = 0;
  };
  std::vector<Awaited> awaited_;  // in the order of asking
  // By their places. Memory is taken for what has come alone, not for what somebody has offered.
  std::map<AuthorId, std::map<std::uint64_t, std::string>> content_;
  std::uint64_t held_bytes_ = 0;
  std::map<AuthorId, std::set<std::size_t>> givers_;
};

class Fetch {
 public:
  Fetch(const std::vector<Provider>& providers, std::uint64_t session, const FetchOptions& options)
      : session_(session), options_(options), patience_(io_), deadline_(io_), offers_due_(io_) {
    for (const Provider& provider : providers) {
      if (peers_.size() < options.providers) peers_.push_back(Peer{.provider = provider, .held = {}, .said = {}});
    }
  }

  std::expected<Snapshot, std::string> run() {
    if (peers_.empty()) return std::unexpected("no peer gives its world to joining peers");
    // All connections begin at once, beside the offers: each takes a round trip, too.
    const std::size_t share = std::max<std::size_t>(1, options_.connections / peers_.size());
    for (std::size_t peer = 0; peer < peers_.size(); ++peer) {
      for (std::size_t i = 0; i < share; ++i) connect(peer);
    }
    be_patient();
    io_.run();
    if (!error_.empty()) return std::unexpected(error_);
    return std::move(snapshot_);
  }

 private:
  struct Peer {
    Provider provider;
    std::optional<Offer> offer{};            // that it has made; whether it counts is to be decided
    std::map<AuthorId, std::uint64_t> held;  // lengths; empty: none of its offers counts
    bool is_asked_for_offer = false;
    bool is_asked_for_digests = false;
    bool has_compared = false;  // its digests of what others gave are here
    bool is_of_use = true;
    int unproven = 0;            // how often in a row it has closed a connection before it said anything in the key
    std::set<std::string> said;  // notes about it
  };
  struct Connection {
    std::size_t peer;
    std::shared_ptr<FramedStream> stream;
    int attempt = 0;  // Peer::unproven as it was
    bool is_connected = false, asks_for_offer = false;
    bool has_provided = false, asks_for_digests = false;
    std::optional<OperationRange> awaits;
    std::set<OperationRange> asked;
  };
  using ConnectionPtr = std::shared_ptr<Connection>;

  void connect(std::size_t peer) {
    if (over_ || !peers_[peer].is_of_use) return;
    const auto connection = std::make_shared<Connection>(
        Connection{.peer = peer, .stream = nullptr, .attempt = peers_[peer].unproven, .awaits = {}, .asked = {}});
    connection->stream = std::make_shared<FramedStream>(
        FramedStream::Socket(io_), kReplyMax_bytes, options_.patience,
        [this, weak = std::weak_ptr(connection)](const std::string& why) {
          if (const auto failed = weak.lock()) on_failure(failed, why);
        },
        seal());
    connections_.insert(connection);
    // Older peers take no proof.
    const auto proof = peers_[peer].unproven % 2 == 0 ? FramedStream::Proof::kWith : FramedStream::Proof::kWithout;
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
        received_bytes_ += frame.size();
        peers_[connection->peer].unproven = 0;
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
    ask(connection, {session_, OfferRequest{}}, [this, connection](Reply reply) {
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
    std::uint64_t bytes = offer.archive_bytes;
    for (const LogLength& log : offer.logs) bytes = std::min(kSnapshotMax_bytes + 1, bytes + log.bytes);
    if (bytes > kSnapshotMax_bytes) return give_up(connection, "its world is larger than 1 GiB");
    peer.offer = std::move(offer);
    if (snapshot_.provided_by.empty()) {
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
    be_patient();
    ask_on_all();
  }

  // Takes the world that most addresses offer; of two that as many do, the one that was offered by the earlier
  // provider. A single computer may answer for many peers.
  void choose() {
    if (over_ || !snapshot_.provided_by.empty()) return;
    std::map<std::size_t, std::set<asio::ip::address>> addresses;  // by the first peer that offers it
    for (std::size_t peer = 0; peer < peers_.size(); ++peer) {
      if (!peers_[peer].is_of_use || !peers_[peer].offer) continue;
      const auto same = std::ranges::find_if(
          addresses, [&](const auto& each) { return is_same_world(*peers_[each.first].offer, *peers_[peer].offer); });
      addresses[same == addresses.end() ? peer : same->first].insert(peers_[peer].provider.at.address());
    }
    if (addresses.empty()) return;
    first_ = std::ranges::max_element(addresses, {}, [](const auto& each) { return each.second.size(); })->first;
    const Peer& chosen = peers_[first_];
    session_ = chosen.offer->session;
    snapshot_.provided_by = chosen.provider.name;
    snapshot_.offer = *chosen.offer;
    parts_.plan(snapshot_.offer);
    be_quick();
    for (std::size_t peer = 0; peer < peers_.size(); ++peer) {
      if (peers_[peer].offer && peers_[peer].is_of_use) accept_offer(peer);
    }
    be_patient();
    ask_on_all();
  }

  [[nodiscard]] static bool is_same_world(const Offer& one, const Offer& other) {
    return one.session == other.session && one.genesis == other.genesis && one.archive_digest == other.archive_digest &&
           one.archive_bytes == other.archive_bytes;
  }

  // Once it is known which world it is.
  void accept_offer(std::size_t index) {
    Peer& peer = peers_[index];
    if (!is_same_world(*peer.offer, snapshot_.offer)) {
      const bool is_same_genesis = peer.offer->genesis == snapshot_.offer.genesis;
      return give_up(index, is_same_genesis ? "it has packed the world's files in another way"
                                            : "it offers another world than most");
    }
    peer.held = {{replication::kNoAuthor, peer.offer->archive_bytes}};
    for (const LogLength& log : peer.offer->logs) peer.held[log.author] = log.bytes;
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
      if (parts_.held_bytes() > kUnpackedFree_bytes + kUnpackedTimes * received_bytes_) {
        return end(peers_[connection->peer].provider.name + " packs its world as only nonsense is packed");
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
    if (std::exchange(compares_, true)) return ask_for_digests();
    if (digest(parts_.content(replication::kNoAuthor)) != snapshot_.offer.archive_digest) {
      return end("what came is not the archive that " + snapshot_.provided_by + " has offered");
    }
    be_patient();
    ask_for_digests();
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
    // Its other connections of the same attempt fail likewise, and count once.
    if (connection->is_connected && connection->stream->is_unproven() && !is_full &&
        connection->attempt == peer.unproven && ++peer.unproven >= kUnprovenTries) {
      return give_up(connection,
                     why + ", as who has another key does, or no place for who joins; --key FILE says a key");
    }
    drop(connection);
    note(connection->peer, is_full ? "it has no place for more who join" : why);
    if (compares_) return ask_for_digests();
    const auto again = std::make_shared<asio::steady_timer>(io_, kConnectedAgainAfter);
    again->async_wait([this, again, peer = connection->peer](const boost::system::error_code&) { connect(peer); });
    ask_on_all();
  }

  // The peer is of no use: it is not asked again.
  void give_up(const ConnectionPtr& connection, const std::string& why) { give_up(connection->peer, why); }
  void give_up(std::size_t peer, const std::string& why) {
    peers_[peer].is_of_use = false;
    for (const ConnectionPtr& each : std::set(connections_)) {
      if (each->peer == peer) drop(each);
    }
    note(peer, why);
    if (compares_) return ask_for_digests();
    if (std::ranges::none_of(peers_, &Peer::is_of_use)) return end(last_failure_);
    if (awaits_offers_ && std::ranges::all_of(peers_, [](const Peer& p) { return !p.is_of_use || p.offer; })) choose();
    ask_on_all();
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
      if (!cancelled) end(compares_ ? "" : "it came too slowly: " + snapshot_.provided_by + " may hold it up");
    });
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

  std::uint64_t session_;
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
  std::uint64_t received_bytes_ = 0;  // as they came
  bool awaits_offers_ = false, compares_ = false, over_ = false;
};

}  // namespace

std::expected<Snapshot, std::string> fetch_snapshot(const std::vector<Provider>& providers, std::uint64_t session,
                                                    const FetchOptions& options) {
  return Fetch(providers, session, options).run();
}

}  // namespace peerd::snapshot
