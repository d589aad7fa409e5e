#include "peerd/daemon/loop/network_watch.hpp"

#include <utility>

namespace peerd {
namespace {

// A trouble is said within 3 s.
constexpr std::chrono::milliseconds kLookPeriod{250};
constexpr Duration kFollowPeriod = std::chrono::seconds(1);
// A peer asks for a second whether it runs already, and then hears hellos, which come at least once a second.
constexpr Duration kOthersAreHeardWithin = std::chrono::milliseconds(2700);

// How far the author's last edit is stamped ahead of session time.
Duration ahead_of(const replication::Peer& peer, replication::AuthorId author, HostTime now) {
  if (!peer.clock().synchronised() || peer.logs().last(author).number == 0) return Duration{0};
  return peer.logs().last_stamp(author) - peer.clock().to_session(now);
}

}  // namespace

NetworkWatch::NetworkWatch(boost::asio::io_context& io, Parts parts)
    : parts_(std::move(parts)), timer_(io), opened_at_(parts_.clock.now()), followed_at_(opened_at_) {
  // The opening of the transport has said that one.
  if (const std::string here = only_here(parts_.transport.why_only_here()); !here.empty()) said_.note(opened_at_, here);
  look();
}

void NetworkWatch::look() {
  const HostTime now = parts_.clock.now();
  find_troubles(now);
  if (parts_.join_service != nullptr && now - followed_at_ >= kFollowPeriod) {
    parts_.join_service->follow_network();
    followed_at_ = now;
  }
  timer_.expires_after(kLookPeriod);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) look();
  });
}

void NetworkWatch::find_troubles(HostTime now) {
  const replication::Peer& peer = parts_.node.peer();
  troubles_ = one_way_links_.find(peer.members(), now);
  for (const PeerId deaf : parts_.deaf_peers()) troubles_.push_back(one_way_link(deaf));
  if (std::string ahead = edits_ahead(ahead_of(peer, parts_.author, now)); !ahead.empty()) {
    if (!std::exchange(has_begun_log_, true)) parts_.begin_log();
    troubles_.push_back(std::move(ahead));
  }
  if (std::string here = only_here(parts_.transport.why_only_here()); !here.empty()) {
    troubles_.push_back(std::move(here));
  }
  const bool hears_nobody = peer.counters().datagrams_in == 0 && now - opened_at_ >= kOthersAreHeardWithin;
  if (!parts_.provider.empty() && hears_nobody) troubles_.push_back(nothing_heard(parts_.provider));
  for (const std::string& trouble : said_.due(now, troubles_)) parts_.log({LogLevel::kWarning, trouble});
}

}  // namespace peerd
