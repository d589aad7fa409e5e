#include "peerd/cli/client/ctl_command.hpp"

#include <chrono>
#include <iostream>
#include <thread>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/cli/client/peer_replies.hpp"
#include "peerd/cli/client/peer_tables.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/peer/control/control_client.hpp"
#include "peerd/peer/control/control_path.hpp"
#include "peerd/peer/node/counter_meanings.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

std::string vector(const Json& v) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>());
}

void print_objects(const Json& reply) {
  std::cout << table_of(object_columns(reply.at("objects")));
  if (!reply.at("next").is_null()) std::cout << "and more: see peerd ctl objects\n";
}

// A time such as "12.345 ms", or `unknown` where the peer does not know it.
std::string milliseconds(const Json& t, const char* unknown = "unknown") {
  return t.is_null() ? unknown : fmt::format("{:.3f} ms", t.get<double>());
}

void print_clock(const Json& clock) {
  std::cout << fmt::format(
      "session time: {} ahead of this host's clock, error at most {}, {} to slew; the OS clock {}\n",
      milliseconds(clock.at("offset_ms")), milliseconds(clock.at("error_ms")), milliseconds(clock.at("to_slew_ms")),
      clock.at("os_clock_error_ms").is_null() ? "does not know its error"
                                              : "is off by at most " + milliseconds(clock.at("os_clock_error_ms")));
}

void print_peers(const Json& reply) {
  print_clock(reply.at("clock"));
  std::cout << table_of(peer_columns(reply));
  for (const Json& r : reply.at("regions")) {
    std::cout << fmt::format("region {}: {}, {} in; {}, {} out", r.at("region").get<std::uint64_t>(),
                             counted(r.at("datagrams_in").get<std::uint64_t>(), "datagram"),
                             counted(r.at("bytes_in").get<std::uint64_t>(), "byte"),
                             counted(r.at("datagrams_out").get<std::uint64_t>(), "datagram"),
                             counted(r.at("bytes_out").get<std::uint64_t>(), "byte"));
    for (const auto& [why, count] : r.at("drops").items())
      std::cout << fmt::format("; dropped {}: {}", why, count.get<std::uint64_t>());
    std::cout << '\n';
  }
}

void print_status(const Json& reply) {
  const auto seconds = [](const Json& t) {
    return t.is_null() ? "none yet" : fmt::format("{:.3f} s", t.get<double>());
  };
  std::cout << fmt::format("peer {} (id {}): {}, world time {}, since the start {}\n",
                           reply.at("peer").at("name").get<std::string>(),
                           reply.at("peer").at("id").get<std::uint64_t>(),
                           reply.at("session").at("joined").get<bool>() ? "in session" : "not in a session yet",
                           seconds(reply.at("world_time_s")), seconds(reply.at("since_start_s")));
  std::cout << fmt::format("session time is {} ahead of this host's clock, error at most {}\n",
                           milliseconds(reply.at("session").at("clock_offset_ms")),
                           milliseconds(reply.at("session").at("clock_error_ms")));
  if (reply.contains("shown")) {
    const Json& shown = reply.at("shown");
    std::cout << fmt::format("shows all as it was {} ago, own objects too; the latest came {} too late\n",
                             milliseconds(shown.at("delay_ms")), milliseconds(shown.at("latest_by_ms")));
  }
  if (!reply.at("session").at("sealed").get<bool>()) {
    std::cout << "open: whoever is on this network can listen, and speak as any peer\n";
  } else {
    std::cout << fmt::format("sealed by {}\n", reply.at("session").at("sealed_by").get<std::string>());
  }
  for (const Json& w : reply.value("waits_for", Json::array())) {
    std::cout << fmt::format("waits for peer {} (id {}): nothing moves before\n", w.at("name").get<std::string>(),
                             w.at("id").get<std::uint64_t>());
  }
  for (const Json& trouble : reply.value("troubles", Json::array())) {
    std::cout << "warning: " << trouble.get<std::string>() << '\n';
  }
  for (const Json& m : reply.at("members")) {
    std::cout << fmt::format("with peer {} (id {}){}\n", m.at("name").get<std::string>(),
                             m.at("id").get<std::uint64_t>(),
                             m.at("joined").get<bool>() ? "" : ", not in a session yet");
  }
  print_objects(reply);
  for (const auto& [name, count] : reply.at("counters").items()) {
    if (count == 0) continue;
    const std::string_view meaning = meaning_of_counter(name);
    std::cout << fmt::format("{}: {}{}\n", name, count.get<std::uint64_t>(),
                             meaning.empty() ? "" : fmt::format(" ({})", meaning));
  }
}

void print_pose(const Json& reply) {
  for (const Json& refused : reply.at("refused")) {
    std::cout << fmt::format("the pose of {} is not used: {}\n", refused.at("object").get<std::string>(),
                             refused.at("why").get<std::string>());
  }
}

void print_key(const Json& reply) {
  const std::string key = reply.at("key").get<std::string>();
  if (reply.contains("refused"))
    std::cout << key << " does nothing: " << reply.at("refused").get<std::string>() << '\n';
  if (!reply.contains("refused") && reply.at("hits") == 0) std::cout << key << ": no enabled KeySensor listens to it\n";
  for (const Json& c : reply.at("changes")) {
    const std::string what = fmt::format("{}: {}", key, c.at("sensor").get<std::string>());
    const std::string recipient = c.at("recipient").get<std::string>();
    if (c.contains("refused")) {
      std::cout << fmt::format("{} does not move {}: {}\n", what, recipient, c.at("refused").get<std::string>());
    } else {
      std::cout << fmt::format("{} {} {} m/s\n", what,
                               c.at("absolute").get<bool>() ? "sets the velocity of " + recipient + " to"
                                                            : "changes the velocity of " + recipient + " by",
                               vector(c.at("velocity_m_s")));
    }
  }
}

constexpr std::chrono::milliseconds kAskedEvery{20};

// Waits until the operation of the reply has taken effect and is stored, or held by another peer; where nobody else is
// here and the peer has no store, there is nothing to wait for. Returns the last word on it.
Result<Json> await_operation(const std::filesystem::path& socket, const Json& edit,
                             std::chrono::milliseconds patience) {
  Json request{{"do", "operation"}};
  request.update(edit.at("operation"));
  const auto give_up = std::chrono::steady_clock::now() + patience;
  for (;;) {
    auto state = ask_peer(socket, json_line(request));
    if (!state) return state;
    const bool nowhere_else = state->at("alone").get<bool>() && !state->value("stores", false);
    const bool safe = state->at("held").get<bool>() || state->value("stored", false) || nowhere_else;
    if ((state->at("applied").get<bool>() && safe) || !state->at("done").get<bool>() ||
        std::chrono::steady_clock::now() > give_up)
      return state;
    std::this_thread::sleep_for(kAskedEvery);
  }
}

void print_edit(const Json& reply) {
  const std::string edit = reply.at("edit").get<std::string>();
  if (reply.contains("refused")) {
    std::cout << fmt::format("{} is not done: {}\n", edit, reply.at("refused").get<std::string>());
    return;
  }
  const Json& id = reply.at("operation");
  const char* const state = !reply.at("applied").get<bool>() ? "has not taken effect yet"
                            : reply.value("stored", false)   ? "done, and stored"
                            : reply.at("held").get<bool>()   ? "done, and held by another peer"
                            : reply.value("stores", false)   ? "done, but neither stored nor held by another peer"
                            : reply.at("alone").get<bool>()  ? "done, and held by this peer alone: no other is here"
                                                             : "done, but no other peer says that it holds it";
  std::cout << fmt::format("{}: operation {}:{}, {}\n", edit, id.at("author").get<std::uint64_t>(),
                           id.at("number").get<std::uint64_t>(), state);
}

void print_conflicts(const Json& reply) {
  const auto operation = [](const Json& o) {
    return fmt::format("operation {}:{}, at {:.3f} s", o.at("author").get<std::uint64_t>(),
                       o.at("number").get<std::uint64_t>(), o.at("at_s").get<double>());
  };
  for (const Json& c : reply.at("conflicts")) {
    const std::string value = c.at("value").is_null() ? "" : " " + c.at("value").get<std::string>();
    const Json& winner = c.at("winner");
    std::cout << fmt::format(
        "{}{} ({}) is lost: {}\n", c.at("what").get<std::string>(), value, operation(c.at("lost")),
        winner.is_null() ? "what it needs is not there"
                         : fmt::format("{} ({}) counts", winner.at("what").get<std::string>(), operation(winner)));
  }
  if (const auto forgotten = reply.at("forgotten").get<std::uint64_t>(); forgotten > 0) {
    std::cout << fmt::format("and {} more, which had no room and are forgotten\n", forgotten);
  }
}

// A value, or keys, line by line.
void print_data(const Json& reply) {
  if (reply.contains("refused")) {
    std::cout << fmt::format("{}: {}\n", reply.at("path").get<std::string>(), reply.at("refused").get<std::string>());
  } else if (reply.contains("value")) {
    std::cout << reply.at("value").get<std::string>() << '\n';
  } else {
    for (const Json& key : reply.at("keys")) std::cout << key.get<std::string>() << '\n';
  }
}

// Prints events until there have been as many as wanted, or the peer ends.
int follow(const std::filesystem::path& socket, const CtlOptions& options) {
  Result<void> refused;
  std::uint64_t lines = 0;  // the reply is the first one
  const auto done = control::listen(socket, options.request, [&](const std::string& line) {
    if (lines++ == 0) {
      const auto reply = read_reply(socket, line);
      if (!reply) refused = std::unexpected(reply.error());
      return reply.has_value();
    }
    std::cout << line << '\n' << std::flush;  // at once, for whoever reads it
    return std::cout.good() && lines != options.events + 1;
  });
  if (!done) return failed(done.error());
  return refused ? 0 : failed(refused.error());
}

}  // namespace

int run_ctl(const CtlOptions& options) {
  const auto socket = options.socket.empty() ? control::find_socket(options.name) : options.socket;
  if (!socket) return failed(socket.error());
  if (options.follows) return follow(*socket, options);
  auto read = ask_peer(*socket, options.request);
  if (!read) return failed(read.error());
  Json& reply = *read;
  if (reply.contains("edit") && reply.contains("operation")) {
    const auto state = await_operation(*socket, reply, options.patience);
    if (!state) return failed(state.error());
    reply.update(*state);
  }
  if (reply.contains("world") && reply.at("world").is_null()) {
    return failed({"error: " + reply.at("refused").get<std::string>(), kFinding});
  }
  if (reply.contains("world") && !options.save.empty()) {
    const auto written = write_text_file(options.save, reply.at("world").get<std::string>());
    return written ? 0 : failed(written.error());
  }
  if (options.json) {
    std::cout << json_line(reply) << '\n';
  } else if (reply.contains("peers")) {
    print_peers(reply);
  } else if (reply.contains("peer")) {
    print_status(reply);
  } else if (reply.contains("edit")) {
    print_edit(reply);
  } else if (reply.contains("conflicts")) {
    print_conflicts(reply);
  } else if (reply.contains("keys") || reply.contains("value")) {
    print_data(reply);
  } else if (reply.contains("world")) {
    std::cout << reply.at("world").get<std::string>();
  } else if (reply.contains("key")) {
    print_key(reply);
  } else if (reply.contains("taken")) {
    print_pose(reply);
  } else if (reply.contains("objects")) {
    print_objects(reply);
  }
  const bool is_refused = reply.contains("done") && !reply.at("done").get<bool>();
  const bool is_unseen = reply.contains("applied") && !reply.at("applied").get<bool>();
  return is_refused || is_unseen ? kFinding : 0;
}

}  // namespace peerd
