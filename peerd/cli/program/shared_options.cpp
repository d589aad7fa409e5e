#include "peerd/cli/program/shared_options.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "peerd/cli/shell/number_checks.hpp"

namespace peerd {
namespace {

constexpr std::int64_t kPeerIdMax = std::numeric_limits<std::uint32_t>::max();

}  // namespace

void add_format_options(CLI::App& command, std::string& collide, std::string& unit, std::string& up) {
  command.add_option("--collide", collide,
                     "what may meet what: all, none, or paths and patterns with commas between them, each of which may "
                     "meet the others (default: as WORLD.peerd.toml and the world say)");
  command
      .add_option("--unit", unit,
                  "of the file's lengths: m, cm, mm, in or ft (default: as WORLD.peerd.toml says, else m)")
      ->check(CLI::IsMember({"m", "cm", "mm", "in", "ft"}));
  command.add_option("--up", up, "the file's axis that points up: y or z (default: as WORLD.peerd.toml says, else y)")
      ->check(CLI::IsMember({"y", "z"}));
}

void add_network_options(CLI::App& command, RunFlags& flags) {
  command.add_option("--interface", flags.interface,
                     "network interface, such as eth0 (default: the configuration's, else the only one that can "
                     "multicast, else lo)");
  auto* const group = command.add_option(
      "--group", flags.group,
      "multicast group of region 0, IPv4 or IPv6 (default: the configuration's, else 239.192.80.0, or ff15::50:0 where "
      "only IPv6 is to be had)");
  command.add_flag("--ipv6", flags.ipv6, "the same as --group ff15::50:0")->excludes(group);
  command.add_option("--port", flags.port, "UDP port (default: the configuration's, else 47474)")
      ->transform(whole_number_in(1, 65535));
  command
      .add_option("--relay", flags.relays,
                  "HOST:PORT of a peerd relay that reaches all others (repeatable: the first that answers)")
      ->allow_extra_args(false);
}

void add_own_options(CLI::App& command, PeerOptions& peer, RunFlags& flags, const std::string& described) {
  command.add_option("--name", flags.name, "this peer's name" + described + " (default: peer)");
  command
      .add_option("--id", flags.id,
                  "this peer's number; each peer needs its own (default: that of its store, else a random one)")
      ->transform(whole_number_in(1, kPeerIdMax));
  command.add_option("--own", flags.owns, "a node of the world that this peer runs (repeatable)")
      ->allow_extra_args(false);
  command.add_option("--control", peer.control,
                     "where peerd ctl reaches this peer: the path of a socket, or \"\" for none (default: the "
                     "configuration's, else one in this user's own folder)");
  command
      .add_option(
          "--view", peer.view,
          "serve the viewer there (default: the configuration's, else none; without a value 127.0.0.1:0, a port "
          "that the system chooses)")
      ->expected(0, 1)
      ->option_text("[ADDRESS:PORT]")
      ->default_str("127.0.0.1:0");
  command.add_option("--record", peer.record, "write what this peer did and believed to a file when it leaves");
  command.add_flag("--take-over", peer.take_over,
                   "begin at once, without asking for a second whether this peer is running already: that one ends");
  command
      .add_option(
          "--nats", flags.nats,
          "URL of a NATS server by which datagrams go, such as nats://host:4222; a user's password is safer in a "
          "configuration (repeatable; default: the configuration's, else none)")
      ->allow_extra_args(false);
  auto* const open = command.add_flag("--open", flags.open,
                                      "nothing is sealed: whoever is on the network can listen, and speak as any peer");
  auto* const key =
      command
          .add_option("--key", flags.key,
                      "the file of the key by which the world's peers seal all that they send (default: the "
                      "configuration's, else this user's own of that world, which is made where there is none)")
          ->excludes(open);
  command
      .add_option("--password-file", flags.password,
                  "the file of a password that makes the key, in place of --key; -: asks for it")
      ->excludes(open)
      ->excludes(key);
  auto* const json = command.add_flag_callback(
      "--json", [&peer] { peer.log = LogFormat::kJson; }, "the same as --log json");
  add_log_option(command, peer.log)->excludes(json);
  command.add_flag("-v,--verbose", peer.verbose, "log updates and predictions too");
}

CLI::Option* add_log_option(CLI::App& command, LogFormat& format) {
  const auto set_format = [&format](const std::string& word) {
    format = word == "json" ? LogFormat::kJson : word == "journal" ? LogFormat::kJournal : LogFormat::kText;
  };
  return command
      .add_option_function<std::string>(
          "--log", set_format,
          "what log lines are: text, json, or journal, which has priorities for systemd's (default: text)")
      ->check(CLI::IsMember(std::vector<std::string>{"text", "json", "journal"}).description(""));
}

void add_store_options(CLI::App& command, StoreOptions& store, const std::string& by_default) {
  command.add_option("--store", store.folder,
                     "a folder in which the edits of all peers are kept: the world is there again after all have "
                     "left; \"\" for none (default: " +
                         by_default + ")");
  command.add_flag("--fresh", store.fresh, "begin with the world's file: the store before is put aside");
}

void add_ask_options(CLI::App& command, AskFlags& flags) {
  command.add_option("--interface", flags.interface,
                     "network interface, such as eth0 (default: the only one that can multicast, else lo)");
  command.add_flag("--ipv6", flags.ipv6, "ask by IPv6 (default: only where there is nothing else)");
}

}  // namespace peerd
