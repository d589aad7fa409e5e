#include "peerd/lab/live/lab.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/lab/live/link_probe.hpp"
#include "peerd/lab/live/netem_settings.hpp"

namespace peerd::live {
namespace {

// A file system in memory that only this process and its children see. `ip netns` keeps the names of namespaces here,
// and files that `ip` and `tc` read are here too.
constexpr const char* kNames = "/run/netns";

InputError missing(const std::string& what) { return {"error: no network by netem here: " + what, kSystemFailed}; }
InputError system_lacks(const std::string& what) {
  return missing(what + ": " + std::generic_category().message(errno));
}

std::string name(std::size_t peer) { return fmt::format("peer{}", peer); }
std::string device(std::size_t from, std::size_t to) { return fmt::format("i{}-{}", from, to); }
std::string hardware_address(std::size_t peer) { return fmt::format("02:00:00:00:00:{:02x}", peer + 1); }

bool write_text(const std::string& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  return static_cast<bool>(out.flush());
}

// Runs lines by `ip -batch` or `tc -batch`. Their complaints go to standard error.
Result<void> run_batch(const std::string& tool, const std::string& lines, const std::string& what) {
  const std::string file = std::string(kNames) + "/.batch";
  if (!write_text(file, lines)) return std::unexpected(system_lacks("can't write " + file));
  if (std::system((tool + " -batch " + file).c_str()) != 0) return std::unexpected(missing(what));
  return {};
}

Result<void> own_namespaces() {
  if (unshare(CLONE_NEWNET | CLONE_NEWNS) != 0) return std::unexpected(system_lacks("namespaces of its own (as root)"));
  std::error_code error;
  std::filesystem::create_directories(kNames, error);
  if (mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("none", kNames, "tmpfs", 0, nullptr) != 0) {
    return std::unexpected(system_lacks(std::string("a file system of its own at ") + kNames));
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<Lab>> Lab::build(std::size_t peers) {
  if (peers > kPeersMax) return std::unexpected(missing(fmt::format("{} peers at most", kPeersMax)));
  if (auto done = own_namespaces(); !done) return std::unexpected(done.error());
  std::string names, ports, devices, queues;
  for (std::size_t i = 0; i < peers; ++i) {
    names += fmt::format("netns add {}\n", name(i));
    ports +=
        fmt::format("link add p{0} type veth peer name {1} address {2} netns {3}\nlink set p{0} master bridge up\n", i,
                    kInterface, hardware_address(i), name(i));
    queues += fmt::format("qdisc add dev p{} clsact\n", i);
    for (std::size_t from = 0; from < peers; ++from) {
      if (from == i) continue;
      const std::string to = device(from, i);
      devices += fmt::format("link add {0} type ifb\nlink set {0} up\n", to);
      queues += fmt::format("qdisc add dev {} root netem\n", to);
      for (const char* protocol : {"ip", "ipv6"}) {
        queues += fmt::format(
            "filter add dev p{} egress protocol {} flower src_mac {} action mirred egress redirect dev {}\n", i,
            protocol, hardware_address(from), to);
      }
    }
  }
  auto done = run_batch(
      "ip", "link set lo up\nlink add bridge type bridge mcast_snooping 0\nlink set bridge up\n" + names + ports,
      "a bridge and veth pairs, by package iproute2 and kernel modules bridge and veth");
  if (done) done = run_batch("ip", devices, "kernel module ifb");
  if (done) done = run_batch("tc", queues, "kernel modules sch_netem, sch_ingress, cls_flower and act_mirred");
  for (std::size_t i = 0; i < peers && done; ++i) {
    done =
        run_batch("ip -n " + name(i),
                  fmt::format("link set lo up\naddress add {0}/24 dev {1}\nlink set {1} up\n", address(i), kInterface),
                  "an address for each peer");
  }
  if (!done) return std::unexpected(done.error());
  std::unique_ptr<Lab> lab(new Lab(peers));
  if (done = lab->set_multicast(true); !done) return std::unexpected(done.error());
  return lab;
}

Result<void> Lab::set_multicast(bool on) {
  for (std::size_t i = 0; i < peers_; ++i) {
    // The route leads nowhere. Without it, multicast would take the route of all other packets.
    const std::string lines =
        fmt::format("link set {0} multicast {1}\nroute replace {2} 224.0.0.0/4{3}\n", kInterface, on ? "on" : "off",
                    on ? "unicast" : "unreachable", on ? std::string(" dev ") + kInterface : "");
    if (auto done = run_batch("ip -n " + name(i), lines, "interfaces with multicast or without"); !done) return done;
  }
  return {};
}

std::string Lab::address(std::size_t peer) { return fmt::format("10.83.0.{}", peer + 1); }

std::vector<std::string> Lab::inside(std::size_t peer) {
  return {"ip", "netns", "exec", name(peer), "setpriv", "--pdeathsig", "TERM"};
}

Result<void> Lab::set_links(const config::RunSettings& run) {
  for (std::size_t from = 0; from < peers_; ++from) {
    for (std::size_t to = 0; to < peers_; ++to) {
      if (from == to) continue;
      const NetemSettings s = netem_settings(config::link(run, run.peers[from].name, run.peers[to].name));
      if (!write_text(fmt::format("{}/{}.dist", kNames, kTable), s.table)) {
        return std::unexpected(system_lacks("can't write a table of delays"));
      }
      const std::string dev = device(from, to);
      const std::string command = fmt::format(
          "tc qdisc del dev {1} root && TC_LIB_DIR={0} tc qdisc add dev {1} root {2}", kNames, dev, s.options);
      if (std::system(command.c_str()) != 0) return std::unexpected(missing("tc refused: " + s.options));
    }
  }
  return {};
}

Result<measure::NetworkMeasured> Lab::measure(const config::RunSettings& run) const {
  const int own = open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC);
  std::vector<ProbeSocket> sockets;
  for (std::size_t i = 0; i < peers_; ++i) {
    const int theirs = open(fmt::format("{}/{}", kNames, name(i)).c_str(), O_RDONLY | O_CLOEXEC);
    if (own < 0 || theirs < 0 || setns(theirs, CLONE_NEWNET) != 0)
      return std::unexpected(system_lacks("entering a namespace"));
    close(theirs);
    auto socket = ProbeSocket::open(address(i));
    if (setns(own, CLONE_NEWNET) != 0) return std::unexpected(system_lacks("leaving a namespace"));
    if (!socket) return std::unexpected(socket.error());
    sockets.push_back(std::move(*socket));
  }
  close(own);

  measure::NetworkMeasured measured;
  double longest_ms = 0.0;
  for (const auto& from : run.peers) {
    for (const auto& to : run.peers) {
      measured.links.push_back({PeerId{from.id}, PeerId{to.id}, 0, 0, 0, {}, 0, 0});
      const config::LinkSettings& l = config::link(run, from.name, to.name);
      longest_ms = std::max(longest_ms, 2.0 * (l.latency_ms + l.jitter_ms));
    }
  }
  // A probe that is late by another tenth of a second counts as lost: only a computer that stands still makes it so
  // late.
  if (auto done = probe(sockets, longest_ms + 100.0, measured.links, measured.oversleep_before_ms); !done) {
    return std::unexpected(done.error());
  }
  std::erase_if(measured.links, [](const measure::LinkMeasured& l) { return l.from == l.to; });
  return measured;
}

Result<void> Lab::count(measure::NetworkMeasured& measured) const {
  std::string text;
  FILE* const tc = popen("tc -s -j qdisc show", "r");
  if (tc == nullptr) return std::unexpected(system_lacks("tc"));
  char part[4096];
  for (std::size_t n; (n = fread(part, 1, sizeof part, tc)) > 0;) text.append(part, n);
  if (pclose(tc) != 0) return std::unexpected(missing("tc does not say what it has counted"));
  const auto all = parse_json(text);
  auto link = measured.links.begin();
  for (std::size_t from = 0; from < peers_; ++from) {
    for (std::size_t to = 0; to < peers_; ++to) {
      if (from == to) continue;
      const auto at = std::ranges::find_if(
          all, [&](const auto& q) { return q.at("dev") == device(from, to) && q.at("kind") == "netem"; });
      if (at == all.end()) return std::unexpected(missing("tc has lost " + device(from, to)));
      link->packets = at->at("packets").template get<std::uint64_t>();
      link->packets_lost = at->at("drops").template get<std::uint64_t>();
      ++link;
    }
  }
  return {};
}

}  // namespace peerd::live
