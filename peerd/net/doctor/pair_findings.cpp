#include "peerd/net/doctor/pair_findings.hpp"

#include <algorithm>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/os/datagram_limits.hpp"

namespace peerd::doctor {
namespace {

using nlohmann::ordered_json;

constexpr std::uint16_t kPeersSend_bytes = net::kSentDatagramMax_bytes;
// More than this is lost: objects jump (docs/measurements has what loss costs). A lossless way has none.
constexpr double kLossMost = 0.05;
constexpr double kRoundTripMost_ms = 200.0;
constexpr double kClockMost_ms = 1000.0;

bool works(const Heard& heard) { return heard.any; }
bool both(const Heard& to, const Heard& from) { return works(to) && works(from); }

double ms(Duration duration) { return to_seconds(duration) * 1e3; }

// How peers here and there meet by unicast: what each side gives.
std::string unicast_recipe(const PairOutcome& o) {
  return fmt::format(
      "use unicast: here --set transport.multicast=never --set 'transport.peers=[\"{}\"]', and there "
      "--set transport.multicast=never --set 'transport.peers=[\"{}\"]'",
      o.host_address, o.own_address);
}

std::string port_of(const std::string& address) { return address.substr(address.rfind(':') + 1); }

std::string from_to(const PairOutcome& o, bool outwards) {
  return outwards ? fmt::format("from here to {}", o.host) : fmt::format("from {} to here", o.host);
}

// One way by one path that works, with what is lost of it.
Finding stream_of(const PairOutcome& o, const char* path, const Heard& heard, bool outwards) {
  if (!outwards && !o.result.complete)  // it hears nothing, and has sent no stream
    return {path, Level::kGood, from_to(o, outwards) + ": datagrams arrive; how many are lost was not tried"};
  const std::string arrived =
      fmt::format("{}: {} of {} datagrams arrived", from_to(o, outwards), heard.stream, kStream);
  const double loss = 1.0 - static_cast<double>(heard.stream) / static_cast<double>(kStream);
  if (loss <= kLossMost) return {path, Level::kGood, arrived};
  return {path, Level::kWarning, fmt::format("{}: {:.0f} % are lost", arrived, loss * 100.0),
          "look for a wireless link or a full one between the two"};
}

std::vector<Finding> multicast_findings(const PairOutcome& o) {
  constexpr const char* kName = "multicast";
  const Heard &to = o.result.multicast_out, &from = o.result.multicast_in;
  if (!o.multicast_wanted) return {};
  const bool unicast = both(o.result.unicast_out, o.result.unicast_in);
  const auto level = unicast ? Level::kWarning : Level::kHint;
  if (!o.why_no_multicast.empty()) return {{kName, level, "not tried: " + o.why_no_multicast, unicast_recipe(o)}};
  std::vector<Finding> all;
  const std::string why = fmt::format(
      "a firewall at the receiver (UDP {}, IGMP), a switch or access point that does not forward the group, or "
      "computers in different networks",
      o.group.substr(o.group.find("port ")));
  for (const bool outwards : {true, false}) {
    const Heard& heard = outwards ? to : from;
    if (works(heard)) {
      all.push_back(stream_of(o, kName, heard, outwards));
      continue;
    }
    all.push_back(
        {kName, level,
         fmt::format("{}: nothing of {} arrived over {} ({})", from_to(o, outwards), o.group, o.interface, why),
         unicast ? unicast_recipe(o) : ""});
  }
  if (o.interface_guessed && both(to, from)) {
    all.push_back({kName, Level::kWarning, fmt::format("a peer would use lo, and not {}, without a name", o.interface),
                   fmt::format("name it: --interface {}", o.interface)});
  }
  return all;
}

std::vector<Finding> unicast_findings(const PairOutcome& o) {
  constexpr const char* kName = "unicast";
  const Heard &to = o.result.unicast_out, &from = o.result.unicast_in;
  // Peers that use multicast need no unicast datagrams.
  const bool needed = !multicast_works(o);
  std::vector<Finding> all;
  for (const bool outwards : {true, false}) {
    const Heard& heard = outwards ? to : from;
    if (works(heard)) {
      Finding finding = stream_of(o, kName, heard, outwards);
      if (!needed) finding.level = std::min(finding.level, Level::kHint);
      all.push_back(std::move(finding));
      continue;
    }
    const std::string& receiver = outwards ? o.host_address : o.own_address;
    const std::string refusal = outwards && !o.unicast_problem.empty() ? fmt::format(" ({})", o.unicast_problem) : "";
    all.push_back({kName, needed ? Level::kWarning : Level::kHint,
                   fmt::format("{}: nothing arrived{}", from_to(o, outwards), refusal),
                   fmt::format("let UDP in at {} (a firewall, or a port that is not forwarded)", receiver)});
  }
  return all;
}

Finding length_of(const char* path, const Heard& to, const Heard& from) {
  const std::uint16_t least = std::min(to.largest_bytes, from.largest_bytes);
  if (least >= kPeersSend_bytes) {
    return {"length", Level::kGood, fmt::format("datagrams of {} bytes arrive whole by {}, both ways", least, path)};
  }
  return {
      "length", Level::kWarning,
      fmt::format("of lengths up to 1472 bytes that were tried, {} is the longest that arrives whole by {}, both ways: "
                  "peers send up to {}, which are cut into fragments or lost",
                  least, path, kPeersSend_bytes),
      "raise the MTU of the interfaces between the two (a tunnel, a VPN) to 1228 or more, or 1248 for IPv6"};
}

std::vector<Finding> length_findings(const PairOutcome& o) {
  const PairResult& r = o.result;
  if (both(r.unicast_out, r.unicast_in)) return {length_of("unicast", r.unicast_out, r.unicast_in)};
  if (multicast_works(o)) return {length_of("multicast", r.multicast_out, r.multicast_in)};
  return {};
}

std::string_view word_of(TcpState state) {
  switch (state) {
    case TcpState::kUntried:
      return "untried";
    case TcpState::kWorks:
      return "works";
    case TcpState::kRefused:
      return "refused";
    case TcpState::kNoAnswer:
      return "no answer";
  }
  return "";
}

std::vector<Finding> tcp_findings(const PairOutcome& o) {
  constexpr const char* kName = "tcp";
  std::vector<Finding> all;
  if (!o.tcp_problem.empty()) {
    all.push_back({kName, Level::kHint, fmt::format("from {} to here: not tried ({})", o.host, o.tcp_problem),
                   "end the peer that has the port of transport.snapshot_port for so long"});
  }
  for (const bool outwards : {true, false}) {
    const TcpState state = outwards ? o.result.tcp_out : o.result.tcp_in;
    if (state == TcpState::kUntried) continue;
    if (state == TcpState::kWorks) {
      all.push_back({kName, Level::kGood, fmt::format("{}: connects", from_to(o, outwards))});
      continue;
    }
    all.push_back(
        {kName, Level::kWarning,
         fmt::format("{}: {}; nobody there gets a world from {} (peerd join)", from_to(o, outwards), word_of(state),
                     outwards ? o.host : "here"),
         fmt::format("set transport.snapshot_port {}, and let TCP in at that port", outwards ? "there" : "here")});
  }
  return all;
}

std::vector<Finding> time_findings(const PairOutcome& o) {
  if (!o.result.round_trip) return {};
  const double round_trip = ms(*o.result.round_trip), ahead = ms(o.result.clock_ahead);
  std::vector<Finding> all;
  all.push_back({"round trip", round_trip > kRoundTripMost_ms ? Level::kHint : Level::kGood,
                 fmt::format("{:.3g} ms at least", round_trip)});
  all.push_back(
      {"clocks", std::abs(ahead) > kClockMost_ms ? Level::kHint : Level::kGood,
       fmt::format("that of {} is {:.4g} ms {} this one, to within {:.3g} ms", o.host, std::abs(ahead),
                   ahead < 0.0 ? "behind" : "ahead of", round_trip / 2.0),
       std::abs(ahead) > kClockMost_ms ? "peers find session time by themselves; logs need an NTP client" : ""});
  return all;
}

Finding nobody_answered(const PairOutcome& o) {
  return {
      "answer", Level::kProblem,
      fmt::format("{} ({}) did not answer within {:.0f} s: nothing of it arrived here, by unicast or multicast{}",
                  o.host, o.host_address, to_seconds(o.waited),
                  o.unicast_problem.empty() ? "" : fmt::format(" (sending: {})", o.unicast_problem)),
      fmt::format("run peerd doctor --with {} there at the same time; if it ran, a firewall here drops UDP {}, or the "
                  "two networks are not connected",
                  o.own_address, port_of(o.own_address))};
}

// The findings where no path works both ways.
Finding one_sided(const PairOutcome& o) {
  const char* sentence = o.result.is_heard ? "no way works in both directions: peers would not find each other"
                                           : "it is heard here, and hears nothing of this computer";
  return {"answer", Level::kProblem, fmt::format("{}: {}", o.host, sentence),
          fmt::format("let UDP {} in at {} (a firewall)", port_of(o.host_address), o.host)};
}

ordered_json datagrams_json(const Heard& heard) {
  return {{"arrived", heard.stream}, {"of", kStream}, {"largest_bytes", heard.largest_bytes}};
}

}  // namespace

bool multicast_works(const PairOutcome& o) { return both(o.result.multicast_out, o.result.multicast_in); }

bool any_path_works(const PairOutcome& o) {
  return multicast_works(o) || both(o.result.unicast_out, o.result.unicast_in);
}

std::vector<Finding> pair_findings(const PairOutcome& o) {
  if (!o.result.answered) return {nobody_answered(o)};
  std::vector<Finding> all;
  if (!any_path_works(o)) all.push_back(one_sided(o));
  for (const auto part : {multicast_findings, unicast_findings, length_findings, tcp_findings, time_findings}) {
    std::ranges::move(part(o), std::back_inserter(all));
  }
  return all;
}

ordered_json as_json(const PairOutcome& o) {
  const PairResult& r = o.result;
  ordered_json all = {{"host", o.host},
                      {"address", o.host_address},
                      {"answered", r.answered},
                      {"is_heard", r.is_heard},
                      {"multicast",
                       {{"tried", !o.group.empty()},
                        {"interface", o.interface},
                        {"to", datagrams_json(r.multicast_out)},
                        {"from", datagrams_json(r.multicast_in)}}},
                      {"unicast", {{"to", datagrams_json(r.unicast_out)}, {"from", datagrams_json(r.unicast_in)}}},
                      {"tcp", {{"to", word_of(r.tcp_out)}, {"from", word_of(r.tcp_in)}}},
                      {"round_trip_ms", nullptr},
                      {"clock_ahead_ms", nullptr}};
  if (r.round_trip) {
    all["round_trip_ms"] = ms(*r.round_trip);
    all["clock_ahead_ms"] = ms(r.clock_ahead);
  }
  return all;
}

}  // namespace peerd::doctor
