#include "peerd/net/relay/relay_report.hpp"

#include <optional>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/greeting/address_text.hpp"

namespace peerd::relay {
namespace {

using nlohmann::json;

json ms_of(const std::optional<Duration>& duration) { return duration ? json(to_seconds(*duration) * 1e3) : json(); }

json link_of(const Neighbour& neighbour, const net::LinkMeter& meter) {
  const auto clock = meter.clock();
  return {{"address", net::address_text(neighbour.at)},
          {"kind", neighbour.is_parent  ? "parent"
                   : neighbour.is_relay ? "child"
                                        : "peer"},
          {"round_trip_ms", ms_of(meter.round_trip())},
          {"latency_bound_ms", ms_of(meter.latency_bound())},
          {"loss_in", meter.loss_in()},
          {"loss_out", meter.loss_out()},
          {"clock_offset_ms", clock ? ms_of(clock->middle) : json()},
          {"clock_error_ms", clock ? ms_of(clock->error) : json()},
          {"datagrams_in", neighbour.datagrams_in},
          {"bytes_in", neighbour.bytes_in},
          {"datagrams_out", neighbour.datagrams_out},
          {"bytes_out", neighbour.bytes_out},
          {"over_budget", neighbour.over_budget}};
}

}  // namespace

json report_of(const Relay& relay) {
  json links = json::array(), networks = json::array();
  relay.neighbours().visit([&](const Neighbour& each) {
    links.push_back(link_of(each, each.is_parent ? relay.parents().chosen()->meter : each.meter));
  });
  for (const auto& network : relay.networks()) {
    const net::TrafficCounters& traffic = network->counters();
    networks.push_back({{"network", network->describe()},
                        {"active", network->is_active()},
                        {"peers", network->peers()},
                        {"left_to_another_relay", network->left_to_others()},
                        {"datagrams_in", traffic.packets_in},
                        {"bytes_in", traffic.bytes_in},
                        {"datagrams_out", traffic.packets_out},
                        {"bytes_out", traffic.bytes_out}});
  }
  json counters = relay.traffic().named();
  counters["relay.forwarded"] = relay.counters().forwarded;
  counters["relay.unwanted"] = relay.counters().unwanted;
  counters["relay.greetings"] = relay.counters().greetings;
  counters["relay.out_of_hops"] = relay.counters().out_of_hops;
  counters["relay.over_budget"] = relay.counters().over_budget;
  counters["relay.refused"] = relay.counters().refused;
  return {{"instance", relay.instance()},       {"port", relay.port()},      {"path", relay.path()},
          {"regions", relay.table().regions()}, {"links", std::move(links)}, {"networks", std::move(networks)},
          {"counters", std::move(counters)}};
}

std::string line_of(const Relay& relay) {
  std::size_t peers = 0, relays = 0;
  std::uint64_t datagrams = relay.traffic().packets_in;
  relay.neighbours().visit([&](const Neighbour& each) { ++(each.is_relay ? relays : peers); });
  for (const auto& network : relay.networks()) {
    peers += network->peers();
    datagrams += network->counters().packets_in;
  }
  const net::RelayChoice::Relay* const parent = relay.parents().chosen();
  std::string line = fmt::format("{} peers, {} other relays, {} regions; {} copies of {} datagrams passed on", peers,
                                 relays, relay.table().regions(), relay.counters().forwarded, datagrams);
  if (parent != nullptr && parent->meter.round_trip()) {
    line += fmt::format("; above: {}, {:.1f} ms there and back, {:.1f} % lost on the way down",
                        net::address_text(parent->at), to_seconds(*parent->meter.round_trip()) * 1e3,
                        parent->meter.loss_in() * 100.0);
  }
  return line;
}

}  // namespace peerd::relay
