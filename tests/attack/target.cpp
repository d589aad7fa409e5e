#include "tests/attack/target.hpp"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include <boost/asio/ip/address.hpp>

#include "peerd/net/keys/key_file.hpp"

namespace peerd::attack {
namespace {

std::atomic<bool> over = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal's handler sets it");

}  // namespace

bool is_over() { return over; }

void end_on_signals() {
  for (const int number : {SIGTERM, SIGINT}) std::signal(number, [](int) { over = true; });
}

void fail(const std::string& why) {
  std::cerr << "error: " << why << '\n';
  std::exit(3);
}

keys::SymmetricKey session_key(const Target& target) {
  const auto key = keys::read_key(target.key_file);
  if (!key) fail(key.error().text);
  return *key;
}

keys::Identity identity(const Target& target) {
  if (target.identity_file.empty()) return keys::Identity::random();
  const auto identity = keys::read_identity(target.identity_file);
  if (!identity) fail(identity.error().text);
  return *identity;
}

net::MulticastOptions multicast(const Target& target) {
  const auto groups = net::parse_group_plan("239.192.80.0", target.port);
  if (!groups) fail(groups.error().sentence);
  net::MulticastOptions options;
  options.interface = target.interface;
  options.groups = *groups;
  return options;
}

std::vector<discovery::Found> peers(const Target& target) {
  const net::HostClock clock;
  const auto asked = discovery::ask_who_is_here(clock, multicast(target), std::chrono::seconds(1));
  if (!asked) fail(asked.error().sentence);
  std::vector<discovery::Found> found;
  for (const discovery::Found& each : asked->found) {
    if (each.beacon.world == target.world && each.beacon.sealed) found.push_back(each);
  }
  if (found.empty()) fail("no peer answers for \"" + target.world + "\"");
  return found;
}

snapshot::Provider provider(const Target& target) {
  if (target.at.empty()) {
    const discovery::Found first = peers(target).front();
    return {first.beacon.name, {first.address, first.beacon.snapshot_port}};
  }
  const auto colon = target.at.rfind(':');
  boost::system::error_code failed;
  const auto address = boost::asio::ip::make_address(target.at.substr(0, colon), failed);
  if (failed || colon == std::string::npos) fail("--at has to be ADDRESS:PORT");
  return {target.at, {address, static_cast<std::uint16_t>(std::stoul(target.at.substr(colon + 1)))}};
}

snapshot::Snapshot snapshot(const Target& target) {
  auto got = snapshot::fetch_snapshot({provider(target)}, 0, {.key = session_key(target)});
  if (!got) fail(got.error());
  return *std::move(got);
}

}  // namespace peerd::attack
