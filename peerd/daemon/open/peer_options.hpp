#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "peerd/daemon/log/log.hpp"
#include "peerd/daemon/open/peer_store.hpp"
#include "peerd/net/keys/session_key.hpp"

namespace peerd {

// The PeerOptions say what somebody wants of one real peer.
struct PeerOptions {
  std::filesystem::path config;                 // a scenario file; one of its peers is run
  std::vector<std::filesystem::path> overlays;  // merged over it, in order
  std::vector<std::string> sets;
  std::string peer;                   // one of the configuration's peers; empty: the only one
  std::optional<JoinedWorld> joined;  // its settings stand for `config`
  // Nobody has said which number the peer has: it keeps, with its store, the one that it was given first.
  bool keeps_id = false;
  std::filesystem::path record;   // file for the peer's log; empty: none
  std::filesystem::path capture;  // file for the peer's capture (record/capture.hpp); empty: none
  bool opened = false;            // the capture has what sealed datagrams say, and can be replayed
  // The session's key, where it has been read already; none: the settings say which it is.
  std::optional<keys::SessionKey> key;
  StoreOptions store;
  std::optional<std::string> control;  // path of the control socket, of --control; empty: none
  std::optional<std::string> view;     // ADDRESS:PORT of --view; none: the configuration's, if it has one
  bool take_over = false;              // do not ask whether this peer is running already
  bool once = false;                   // leave when the scenario's duration is over
  LogFormat log = LogFormat::kText;
  bool verbose = false;  // debug lines too
  // Another program has this peer in itself, takes its log, and keeps the process's signals.
  bool embedded = false;
  std::function<void(const LogLine&)> log_to{};  // empty: standard output
};

}  // namespace peerd
