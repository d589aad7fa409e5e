#include "peerd/peer/node/describe.hpp"

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/peer/node/edit_operation.hpp"
#include "replication/wire/codec.hpp"

namespace peerd {
namespace {

using namespace replication;
template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

double ms(Duration d) { return to_seconds(d) * 1e3; }

const char* verb(ContactKind kind) {
  switch (kind) {
    case ContactKind::kOwner:
      return "hit";
    case ContactKind::kDecided:
      return "hit (decided here)";
    case ContactKind::kPredicted:
      return "is predicted to hit";
    case ContactKind::kApplied:
      return "hit (decided there)";
    case ContactKind::kScene:
      return "met";
  }
  return "?";
}

// The deed of a member that met a limit.
const char* said_of(MemberLimit limit) {
  switch (limit) {
    case MemberLimit::kClockAhead:
      return "says a time that is farther from this computer's than replication.clock_ahead_s allows";
    case MemberLimit::kStampAhead:
      return "publishes what is to happen later, by its own clock too";
    case MemberLimit::kOperationAhead:
      return "has sent edits of the future, which wait for their time";
    case MemberLimit::kDecisionImpossible:
      return "has decided a collision that cannot have been";
    case MemberLimit::kDecisionElsewhere:
      return "has decided a collision of others' objects where these are not";
    case MemberLimit::kDatagrams:
      return "sends more datagrams than one peer is allowed";
    case MemberLimit::kDecisions:
      return "sends more decisions than one peer is allowed";
    case MemberLimit::kClaims:
      return "claims more objects of others than one peer is allowed";
    case MemberLimit::kOperations:
      return "sends edits faster than one peer is allowed";
    case MemberLimit::kLogLength:
      return "has sent edits for which there is no room";
    case MemberLimit::kAuthors:
      return "names more authors of edits than one peer is allowed";
    case MemberLimit::kRequests:
      return "asks for edits faster than one peer is allowed";
    case MemberLimit::kResends:
      return "makes others publish everything anew more often than one peer is allowed";
    case MemberLimit::kSubscriptions:
      return "listens to new regions faster than one peer is allowed";
    case MemberLimit::kRestarts:
      return "starts anew more often than one peer is allowed";
  }
  return "?";
}

std::string named(PeerId id, const std::string& name) { return fmt::format("peer {} (id {})", name, id.value); }

// The line of the log for each output of a peer; none for those that only the program acts on.
struct LineOf {
  using Line = std::optional<LogLine>;

  const Scene& scene;

  // The first pair of polygons that touch, as collide names them, and the interest's type.
  [[nodiscard]] std::string touching(const ContactEvent& c) const {
    if (c.polygons.pairs.empty()) return "";
    const auto& [a, b] = c.polygons.pairs.front();
    const std::string more = c.polygons.count > 1 ? fmt::format(" and {} more", c.polygons.count - 1) : "";
    return fmt::format(": {} polygon {} - {} polygon {}{} ({})", path_or_id(scene, a.shape), a.polygon,
                       path_or_id(scene, b.shape), b.polygon, more, name_of(c.type));
  }

  Line operator()(const Send&) const { return std::nullopt; }
  Line operator()(const Join& j) const {
    return LogLine{LogLevel::kDebug, fmt::format("joined region {}", j.region.value)};
  }
  Line operator()(const Leave& l) const {
    return LogLine{LogLevel::kDebug, fmt::format("left region {}", l.region.value)};
  }
  Line operator()(const Synchronised& s) const {
    return LogLine{LogLevel::kInfo, fmt::format("in session: follows the clock of peer {}, offset {:.3f} ms, "
                                                "error at most {:.3f} ms",
                                                s.follows.value, ms(s.session_minus_host), ms(s.error_bound))};
  }
  Line operator()(const ClockStepped& s) const {
    // HostSuspended has told of the stop already.
    return LogLine{s.same_session ? LogLevel::kInfo : LogLevel::kWarning,
                   fmt::format("{}: the session clock stepped forward by {:.3f} ms, offset {:.3f} ms",
                               s.same_session ? "back in the session" : "two sessions have met", ms(s.step),
                               ms(s.session_minus_host))};
  }
  Line operator()(const OsClockDoubted& d) const {
    return LogLine{LogLevel::kWarning,
                   fmt::format("the operating systems' clocks of peer {} and of this computer cannot both be as "
                               "good as they say: {:.3f} ms apart from what the network shows, which takes precedence",
                               d.peer.value, ms(d.apart))};
  }
  Line operator()(const HostSuspended& s) const {
    return LogLine{LogLevel::kWarning, fmt::format("this peer was stopped for {:.1f} s; its objects go on from where "
                                                   "they were",
                                                   to_seconds(s.gap))};
  }
  Line operator()(const PeerJoined& p) const {
    return LogLine{LogLevel::kInfo, named(p.peer, p.name) + (p.restarted ? " restarted" : " joined")};
  }
  Line operator()(const PeerLost& p) const {
    return p.left_gracefully ? LogLine{LogLevel::kInfo, named(p.peer, p.name) + " left"}
                             : LogLine{LogLevel::kWarning, named(p.peer, p.name) + " is lost: it has gone silent"};
  }
  Line operator()(const ObjectOrphaned& f) const {
    return LogLine{LogLevel::kWarning, fmt::format("{} stands still: its owner, peer {}, is gone",
                                                   path_or_id(scene, f.object), f.owner.value)};
  }
  Line operator()(const OtherVersion& o) const {
    return LogLine{LogLevel::kError,
                   fmt::format("peer {} speaks version {} of the protocol, this one version {}: neither hears "
                               "the other; give all peers the same peerd",
                               o.peer.value, o.version, replication::kProtocolVersion)};
  }
  Line operator()(const OtherWorld& o) const {
    return LogLine{LogLevel::kWarning, named(o.peer, o.name) +
                                           " has another world and is ignored; give both the "
                                           "same file, and the same [regions]"};
  }
  Line operator()(const LineTaken& l) const {
    return LogLine{LogLevel::kInfo,
                   fmt::format("this peer has no edits of its own, and goes on with those of peer {}'s session (line "
                               "{:016x})",
                               l.from.value, l.line)};
  }
  Line operator()(const OtherLine& o) const {
    return LogLine{LogLevel::kWarning,
                   o.goes_over ? named(o.peer, o.name) +
                                     " is in a session of this world that was begun anew (--fresh): the edits "
                                     "that this peer begins with do not belong there"
                               : named(o.peer, o.name) +
                                     " is in a session of this world that was begun anew (--fresh), and has "
                                     "edits as this one has: the two stay apart; end this peer and start it again "
                                     "to go over, with its edits put aside"};
  }
  Line operator()(const IdInUse& i) const {
    if (!i.is_ours) {
      return LogLine{
          LogLevel::kWarning,
          fmt::format("two programs are peer {}; what the one says that started earlier is dropped", i.peer.value)};
    }
    return LogLine{LogLevel::kError, i.ours_is_replaced
                                         ? fmt::format("another program has taken over as peer {}", i.peer.value)
                                         : fmt::format("another program goes on as peer {}; end it, or give each peer "
                                                       "an id of its own",
                                                       i.peer.value)};
  }
  Line operator()(const NameInUse& n) const {
    return LogLine{LogLevel::kWarning, fmt::format("peers {} and {} have one name, {}; give each peer its own",
                                                   n.other.value, n.peer.value, n.name)};
  }
  Line operator()(const LimitMet& l) const {
    return LogLine{LogLevel::kWarning, fmt::format("peer {} {}: {} times (dropped_{})", l.peer.value, said_of(l.limit),
                                                   l.times, replication::to_string(l.limit))};
  }
  Line operator()(const OwnershipConflict& c) const {
    return LogLine{LogLevel::kError,
                   fmt::format("two peers own {}; peer {} keeps it", path_or_id(scene, c.object), c.owner.value)};
  }
  Line operator()(const FounderGaveWay& g) const {
    return LogLine{
        LogLevel::kInfo,
        fmt::format("{}, which the world's file gave to peer {} as the founder, is peer {}'s by its settings",
                    path_or_id(scene, g.object), g.founder.value, g.owner.value)};
  }
  Line operator()(const SceneEdited& e) const {
    const std::string operation = fmt::format("operation {}:{}", e.operation.author.value, e.operation.number);
    if (e.refused.empty()) return LogLine{LogLevel::kInfo, operation + " takes effect"};
    return LogLine{LogLevel::kWarning, fmt::format("{} changes nothing: {}", operation, e.refused)};
  }
  Line operator()(const DataChanged& d) const {
    return LogLine{LogLevel::kDebug,
                   fmt::format("{} of node {}:{} is {}", json_line(d.key), d.node.origin, d.node.number,
                               d.value ? fmt::format("{} bytes of data", d.value->size()) : "gone")};
  }
  Line operator()(const MessageReceived& m) const {
    return LogLine{LogLevel::kInfo,
                   fmt::format("peer {} sends to all: {}, {} bytes", m.by.value, json_line(m.topic), m.text.size())};
  }
  Line operator()(const OperationHeld& h) const {
    return LogLine{LogLevel::kDebug, fmt::format("operation {}:{} is held by another peer", h.operation.author.value,
                                                 h.operation.number)};
  }
  Line operator()(const ObjectGiven& g) const {
    if (g.owner == kNobody) return LogLine{LogLevel::kInfo, path_or_id(scene, g.object) + " is nobody's"};
    return LogLine{LogLevel::kInfo, fmt::format("{} is peer {}'s", path_or_id(scene, g.object), g.owner.value)};
  }
  Line operator()(const ObjectRequested& r) const {
    return LogLine{LogLevel::kInfo, fmt::format("peer {} asks for {}", r.by.value, path_or_id(scene, r.object))};
  }
  Line operator()(const RequestRefused& r) const {
    return LogLine{LogLevel::kInfo,
                   fmt::format("operation {}:{} is refused: {}", r.request.author.value, r.request.number, r.reason)};
  }
  Line operator()(const LogGrown&) const { return std::nullopt; }
  Line operator()(const DelayShown& d) const {
    return LogLine{LogLevel::kInfo, fmt::format("shows all as it was {:.0f} ms ago, own objects too", ms(d.delay))};
  }
  Line operator()(const CameTooLate& l) const {
    return LogLine{LogLevel::kWarning,
                   fmt::format("came too late to be shown in time: {} updates and {} decisions, by up to {:.1f} ms; {} "
                               "updates never came",
                               l.updates, l.decisions, ms(l.latest_by), l.missing)};
  }
  Line operator()(const Published& p) const {
    return LogLine{LogLevel::kDebug, fmt::format("update of {}: {}, threshold {} m", path_or_id(scene, p.object),
                                                 to_string(p.reason), p.threshold_m)};
  }
  Line operator()(const ContactSeen& c) const {
    const double ago_s = to_seconds(c.known_at - c.contact.at);
    return LogLine{c.kind == ContactKind::kPredicted ? LogLevel::kDebug : LogLevel::kInfo,
                   fmt::format("{} {} {}, {:.1f} ms ago{}", path_or_id(scene, c.contact.collider), verb(c.kind),
                               path_or_id(scene, c.contact.collidee), 1e3 * ago_s, touching(c.contact))};
  }
  Line operator()(const Overruled& o) const {
    return LogLine{LogLevel::kInfo, fmt::format("{} on {}: another peer's decision counts",
                                                path_or_id(scene, o.collider), path_or_id(scene, o.collidee))};
  }
  Line operator()(const ContactsRetracted&) const { return std::nullopt; }
  Line operator()(const BodiesOverlap& o) const {
    return LogLine{LogLevel::kWarning, fmt::format("{} and {} overlap from the start", path_or_id(scene, o.collider),
                                                   path_or_id(scene, o.collidee))};
  }
  Line operator()(const GhostDiffers& d) const {
    const auto level = d.explained ? LogLevel::kDebug : LogLevel::kWarning;
    return LogLine{
        level, fmt::format("peer {} shows {} {:.3g} m from where its owner, peer {}, believes; it is published anew",
                           d.by.value, path_or_id(scene, d.object), d.distance_m, d.owner.value)};
  }
  Line operator()(const NotColliding& n) const {
    return LogLine{LogLevel::kDebug,
                   fmt::format("{} notColliding {}", path_or_id(scene, n.object), n.value ? "TRUE" : "FALSE")};
  }
};

}  // namespace

std::optional<LogLine> describe(const Output& output, const Scene& scene) { return std::visit(LineOf{scene}, output); }

LogLine describe_missing(std::span<const AwaitedPeer> missing) {
  if (missing.empty()) return {LogLevel::kInfo, "all peers are here, and motions begin"};
  std::string all;
  for (const AwaitedPeer& peer : missing) all += (all.empty() ? "" : ", ") + named(peer.id, peer.name);
  return {LogLevel::kInfo, "waits for " + all + ": nothing moves before"};
}

LogLine describe(const feed::Notice& notice) {
  const auto once = notice.again ? LogLevel::kDebug : LogLevel::kWarning;
  switch (notice.kind) {
    case feed::Notice::Kind::kBegan:
      return {LogLevel::kInfo, "a program moves " + notice.what};
    case feed::Notice::Kind::kSilent:
      return {once, notice.what + " stands still: the program that moves it is silent"};
    case feed::Notice::Kind::kResumed:
      return {notice.again ? LogLevel::kDebug : LogLevel::kInfo, notice.what + " gets poses again"};
    case feed::Notice::Kind::kRefused:
      return {once, "a pose of " + notice.what + "; more such are only counted"};
    case feed::Notice::Kind::kNotUnderstood:
      return {once, "a datagram that is no message of poses: " + notice.what + "; more such are only counted"};
  }
  return {LogLevel::kError, "?"};
}

}  // namespace peerd
