#include "tests/sim/dissector/tshark.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "tests/net/process.hpp"

namespace peerd::sim::dissector_test {
namespace {

using peerd::testing_support::Process;
using peerd::testing_support::ScratchFolder;

constexpr const char* kLuaError = "_ws.lua.error";
constexpr std::array kMarks{kMalformed, kMalformedJoin, kUnreadable, kForked};
// What no text of a test has.
constexpr char kSeparator = '\1', kAggregator = '\2';

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) c == at ? static_cast<void>(parts.emplace_back()) : parts.back().push_back(c);
  return parts;
}

// tshark prints 15 digits of a double.
bool same_value(const std::string& ours, const std::string& theirs) {
  if (ours == theirs || ours == kAnyText) return true;
  if (ours.find_first_of(".e") == std::string::npos && theirs.starts_with("0x")) {
    return std::stoull(ours) == std::stoull(theirs, nullptr, 16);
  }
  char *our_end = nullptr, *their_end = nullptr;
  const double x = std::strtod(ours.c_str(), &our_end), y = std::strtod(theirs.c_str(), &their_end);
  if (*our_end != '\0' || *their_end != '\0' || ours.size() + theirs.size() == 0) return false;
  const bool whole = ours.find_first_of(".e") == std::string::npos && theirs.find_first_of(".e") == std::string::npos;
  return whole ? false : std::abs(x - y) <= 1e-14 * std::abs(x);
}

// Whether this is nothing, or zeros: Protobuf sends none, but accepts them.
bool is_absent(const std::vector<std::string>& values) {
  return std::ranges::all_of(values, [](const std::string& value) {
    return value == kNoBytes || value.find_first_not_of(value.starts_with("0x") ? "0x" : "0") == std::string::npos;
  });
}

std::vector<std::string> asked_for() {
  std::vector<std::string> names{kUnknown, kLuaError};
  names.insert(names.end(), kMarks.begin(), kMarks.end());
  for (const auto& more : {fields_of_datagrams(), fields_of_discovery(), fields_of_joins(), fields_of_links()}) {
    names.insert(names.end(), more.begin(), more.end());
  }
  return names;
}

}  // namespace

std::vector<std::string> fields_of_datagrams() {
  std::vector<std::string> names;
  const auto with = [&](const std::string& prefix, std::initializer_list<const char*> ends) {
    for (const char* end : ends) names.push_back("peerd." + prefix + end);
  };
  with("", {"region", "version", "sender", "number", "boot_low", "leaving"});
  with("hello.", {"session_tx_ns", "sessions", "latency_ms", "clock_error_us", "os_minus_session_ns", "os_error_us",
                  "scene_digest"});
  with("scene.", {"since_ns"});
  with("ghosts.", {"time_ns", "number", "owner", "region", "group", "reported", "distance"});
  with("echo.", {"peer", "hello", "held_ns", "newer", "run", "absent", "loss_permille"});
  with("note.", {"collider", "collidee", "contact_ns", "held"});
  with("introduction.", {"name", "world_hash", "boot", "enslaved", "owned_as_founder", "start_ns", "world_zero_ns",
                         "line", "has_edits"});
  with("viewpoint.", {"object", "field_of_view", "aspect"});
  with("record.",
       {"object", "carrier", "sequence", "kind", "time_ns", "decision_ns", "step_log2", "exact", "driven_since_ns"});
  with("decision.", {"collider", "collidee", "contact_ns", "rule", "known_ns", "rests"});
  with("entered.", {"region", "since_ns"});
  with("gone.", {"object", "sequence", "region"});
  with("log.", {"author", "bytes"});
  with("operations.", {"author", "from", "bytes", "asked.author", "asked.from", "asked.bytes"});
  with("operation.", {"kind",
                      "author",
                      "number",
                      "stamp_ns",
                      "from",
                      "bytes",
                      "repeated",
                      "knows.author",
                      "knows.number",
                      "object",
                      "node",
                      "parent",
                      "before",
                      "text",
                      "first_object",
                      "first_node",
                      "name.path",
                      "name.object",
                      "field",
                      "value",
                      "route.from",
                      "route.to",
                      "route.event_out",
                      "route.event_in",
                      "route.removes",
                      "author_key",
                      "signature",
                      "owner",
                      "owner_before",
                      "rotation.angle",
                      "by",
                      "request.author",
                      "request.number",
                      "reason",
                      "at_ns",
                      "key",
                      "data",
                      "topic",
                      "message",
                      "undone.number",
                      "undone.stamp_ns",
                      "redoes",
                      "unlocks"});
  with("", {"operation"});
  with("identity.", {"asker", "world_hash", "answers"});
  with("", {"kind"});
  with("seal.", {"epoch", "sender", "counter"});
  for (const char* vector :
       {"operation.translation", "operation.rotation", "viewpoint.position", "record.position", "record.velocity",
        "record.acceleration", "record.jerk", "record.rate", "record.spin", "record.spin_acceleration", "record.drive",
        "decision.collider_free", "decision.collidee_free", "decision.normal", "decision.position", "decision.velocity",
        "decision.acceleration", "decision.spin"}) {
    with(vector, {".x", ".y", ".z"});
  }
  for (const char* q : {"viewpoint.orientation", "record.orientation", "decision.orientation"}) {
    with(q, {".w", ".x", ".y", ".z"});
  }
  return names;
}

std::vector<std::string> fields_of_links() {
  return {"peerd.hops",          "peerd.greeting.region", "peerd.greeting.sent_at",  "peerd.greeting.echoed",
          "peerd.greeting.held", "peerd.greeting.sent",   "peerd.greeting.received", "peerd.greeting.group_offset",
          "peerd.greeting.path"};
}

std::vector<std::string> fields_of_discovery() {
  return {"peerd.kind",         "peerd.beacon.protocol",    "peerd.beacon.session",       "peerd.beacon.peer",
          "peerd.beacon.name",  "peerd.beacon.incarnation", "peerd.beacon.snapshot_port", "peerd.beacon.world",
          "peerd.beacon.sealed"};
}

std::vector<std::string> fields_of_joins() {
  std::vector<std::string> names;
  for (const char* name : {"kind", "bytes", "session", "range.author", "range.from", "range.to", "log.author",
                           "log.bytes", "protocol", "world", "settings", "genesis", "archive.bytes", "archive.digest",
                           "chunk.bytes", "chunk.unpacked_bytes", "digest", "refusal", "request_in"}) {
    names.push_back(std::string("peerd_join.") + name);
  }
  return names;
}

std::map<std::size_t, Fields> dissected(const ScratchFolder& folder, const std::filesystem::path& file,
                                        const std::vector<std::string>& preferences, bool twice) {
  const std::vector<std::string> names = asked_for();
  std::vector<std::string> words{
      "-r", file.string(),         "-X", "lua_script:" PEERD_SOURCE_DIR "/peerd/packaging/peerd.lua",
      "-Y", "peerd or peerd_join", "-T", "fields",
      "-e", "frame.number"};
  words.insert(words.end(),
               {"-E", std::string("separator=") + kSeparator, "-E", std::string("aggregator=") + kAggregator});
  for (const std::string& name : names) words.insert(words.end(), {"-e", name});
  if (twice) words.push_back("-2");
  for (const std::string& preference : preferences) words.insert(words.end(), {"-o", preference});
  Process tshark(folder, "tshark", kTshark, words);
  EXPECT_EQ(tshark.exit_code(60), 0) << tshark.err();
  EXPECT_EQ(tshark.err().find("Lua"), std::string::npos) << tshark.err();
  std::map<std::size_t, Fields> packets;
  std::istringstream lines(tshark.out());
  for (std::string line; std::getline(lines, line);) {
    const auto columns = split(line, kSeparator);
    EXPECT_EQ(columns.size(), names.size() + 1) << line;
    if (columns.size() != names.size() + 1) continue;
    Fields& fields = packets[std::stoul(columns[0])];
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!columns[i + 1].empty()) fields[names[i]] = split(columns[i + 1], kAggregator);
    }
    EXPECT_FALSE(fields.contains(kLuaError)) << "the dissector fails at packet " << columns[0] << " of " << file;
  }
  return packets;
}

std::string difference(const Fields& ours, Fields theirs) {
  for (const char* mark : kMarks) {
    const std::size_t marks = ours.contains(mark) ? ours.at(mark).size() : 0;
    if (theirs[mark].size() != marks) {
      return std::string(mark) + ": " + std::to_string(theirs[mark].size()) + " times, not " + std::to_string(marks);
    }
    theirs.erase(mark);
  }
  if (ours.contains(kMalformed) || ours.contains(kMalformedJoin)) return "";
  for (const auto& [name, values] : ours) {
    if (std::ranges::find(kMarks, name) != kMarks.end()) continue;
    const auto& found = theirs[name];
    if (found.size() != values.size()) {
      return name + ": " + std::to_string(found.size()) + " times, not " + std::to_string(values.size());
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!same_value(values[i], found[i])) return name + ": " + found[i] + ", not " + values[i];
    }
  }
  for (const auto& [name, values] : theirs) {
    // The dissector sums up in the same field what a datagram has.
    const bool is_summary = name == "peerd.kind" && ours.contains("peerd.sender");
    if (!is_absent(values) && !ours.contains(name) && !is_summary && name != kUnknown) {
      return name + ": " + values.front() + ", which it does not have";
    }
  }
  return "";
}

}  // namespace peerd::sim::dissector_test
