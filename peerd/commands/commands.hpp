#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace peerd {

// The commands behind main(): each prints for a person and returns the exit code (0 good, 1 a finding about the input,
// 2 wrong use or configuration, 3 the environment).

struct ScenarioOptions {
  std::filesystem::path scenario;
  std::vector<std::filesystem::path> configs;
  std::vector<std::string> sets;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint32_t> repeat;  // with so many seeds
  std::filesystem::path out;            // empty: out/NAME
  std::string interface;                // real runs only
  bool netem = false;                   // .. over the network that the scenario describes, by the kernel's netem
  bool tcpdump = false;                 // .. with what each peer sent and got, as a file for tcpdump or Wireshark
  std::filesystem::path captures;       // simulated runs only: a folder for each peer's capture; empty: none
  bool json = false;                    // summary.json instead of the table
  bool verbose = false;                 // the peers' logs too
};

// peerd sim: the scenario on a simulated network, as fast as it goes.
[[nodiscard]] int run_sim(const ScenarioOptions& options);
// peerd scenario: the same scenario between real processes over real multicast.
[[nodiscard]] int run_scenario(const ScenarioOptions& options, const std::filesystem::path& program);

struct PeerOptions {
  std::filesystem::path config;                 // a scenario file; one of its peers is run
  std::vector<std::filesystem::path> overlays;  // merged over it, in order
  std::vector<std::string> sets;
  std::string peer;               // which; empty: the only one
  std::filesystem::path record;   // where to leave the peer's log; empty: nowhere
  std::filesystem::path capture;  // where to keep all that it is told and sends (record/capture.hpp); empty: nowhere
  std::optional<std::string> control;  // of --control: where the control socket is; empty: nowhere
  bool once = false;                   // leave when the scenario's duration is over
  bool json = false;                   // log lines as JSON
  bool verbose = false;                // debug lines too
};

// peerd run, and with a capture peerd record: one peer in the foreground, until SIGTERM or SIGINT.
[[nodiscard]] int run_peer(const PeerOptions& options);

struct ReplayOptions {
  std::filesystem::path file;    // a capture
  std::filesystem::path world;   // where its world is now; empty: where it was
  std::filesystem::path record;  // as of PeerOptions
  bool json = false;
  bool verbose = false;  // the peer's log, too
};

// peerd replay: runs a recorded peer once more on what it was told. 1 when it does not send what it sent then, or the
// file is no capture. As JSON: peer {id, name}, inputs, datagrams_in, datagrams_out (compared), begin_s, duration_s,
// cut_off (the record ends in the middle of a packet), same, difference (null: none) {packet (0: the end), at_s, what}.
[[nodiscard]] int run_replay(const ReplayOptions& options);

struct DoctorOptions {
  std::filesystem::path config;   // whose table [transport] counts; empty: the defaults
  std::vector<std::string> sets;  // over it
  bool json = false;
};

// peerd doctor: whether a peer could reach others from here, and how. 3 when it could not. As JSON: interface {name,
// why} (null: none), multicast {tried, works, took_us, kernel_stamps | problem}, memberships_of_a_socket (null: not by
// number), receive_buffer_bytes {asked, granted}, unicast_needed, unicast_peers, transport ("multicast", "unicast",
// null), problem.
[[nodiscard]] int run_doctor(const DoctorOptions& options);

struct CtlOptions {
  std::string socket;   // where the peer listens; empty: found by its name
  std::string name;     // of the peer; empty: the only one of this user's
  std::string request;  // a line of peerd/api/README.md
  bool json = false;    // print the reply as it came
};

// peerd ctl: asks or tells a peer that runs on this computer. 1 when a key did not do all that it should, or a pose is
// not used.
[[nodiscard]] int run_ctl(const CtlOptions& options);

}  // namespace peerd
