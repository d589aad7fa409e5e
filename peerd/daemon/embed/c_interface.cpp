// The C interface (peerd.h) over EmbeddedPeer. No exception leaves it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/daemon/embed/embedded_peer.hpp"
#include "peerd/daemon/embed/include/peerd/peerd.h"
#include "peerd/daemon/embed/option_values.hpp"
#include "peerd/input/json_text.hpp"

struct peerd_options {
  peerd::embed::OptionValues values;
};

namespace {

using namespace peerd;
using embed::EmbeddedPeer;
using embed::pose_of;
using nlohmann::json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A peerd_peer is an EmbeddedPeer under a name that C knows.
EmbeddedPeer& peer_of(peerd_peer* peer) { return *reinterpret_cast<EmbeddedPeer*>(peer); }

constexpr const char* kOfAnotherProcess =
    "the peer belongs to another process, from which this one was forked; open one here";

bool is_of_another_process(peerd_peer* peer) { return !peer_of(peer).is_of_this_process(); }

// Does something with a peer that is held. What it throws is the error of that call, and `otherwise` its value, which
// it also has in another process.
template <class Value, class Work>
Value with(peerd_peer* handle, Value otherwise, Work work) noexcept {
  if (is_of_another_process(handle)) return otherwise;
  EmbeddedPeer& peer = peer_of(handle);
  const embed::Hold held(peer);
  try {
    return work(peer);
  } catch (const std::exception& thrown) {
    peer.error = thrown.what();
    return otherwise;
  }
}

// Asks by the control protocol. Discarded: it was refused.
json asked(EmbeddedPeer& peer, const json& request) {
  json reply = parse_json(peer.ask(json_line(request)));
  if (reply.value("ok", false)) return reply;
  peer.error = reply.value("error", "");
  return json(json::value_t::discarded);
}

// Asks for an edit. 1: it has become an operation.
int edited(peerd_peer* handle, const std::function<json(EmbeddedPeer&)>& request_of, peerd_operation* operation) {
  if (operation != nullptr) *operation = {};
  return with(handle, 0, [&](EmbeddedPeer& peer) {
    const json request = request_of(peer);
    if (request.is_discarded()) return 0;
    const json reply = asked(peer, request);
    if (reply.is_discarded()) return 0;
    if (!reply.value("done", false)) {
      peer.error = reply.value("refused", "it was refused");
      return 0;
    }
    if (operation != nullptr && reply.contains("operation") && reply["operation"].is_object()) {
      *operation = {reply["operation"].value("author", 0U), reply["operation"].value("number", 0U)};
    }
    return 1;
  });
}

std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }

// The path of an object. None: there is no such object, and the peer's error says so.
std::optional<std::string> path_in(EmbeddedPeer& peer, peerd_object object) {
  const Scene& scene = peer.node().scene();
  const ObjectId id = ObjectId::unpacked(object);
  if (object != PEERD_NO_OBJECT && scene.contains(id)) return scene.path_of(id);
  peer.error = "there is no such object";
  return std::nullopt;
}

// A request about an object. Discarded: there is none.
json about(EmbeddedPeer& peer, const char* what, peerd_object object) {
  const auto path = path_in(peer, object);
  if (!path) return json(json::value_t::discarded);
  return {{"do", what}, {"path", *path}};
}

// Adds the new parent to a request about an object, or to one that adds something.
json below(EmbeddedPeer& peer, json request, peerd_object under) {
  if (request.is_discarded() || under == PEERD_NO_OBJECT) return request;
  const auto path = path_in(peer, under);
  if (!path) return json(json::value_t::discarded);
  request["under"] = *path;
  return request;
}

// A program's function that throws has lost the line, and nothing else: what is under way, in the peer's own thread
// too, goes on. The first one of a program is said on standard error.
void give_line(peerd_log log, void* user, const LogLine& line) noexcept {
  static std::once_flag said;
  const auto say = [&](const char* what) {
    std::call_once(said, [&] { std::fprintf(stderr, "peerd: the function for lines of the log threw: %s\n", what); });
  };
  try {
    log(user, static_cast<int>(line.level), line.text.c_str());
  } catch (const std::exception& thrown) {
    say(thrown.what());
  } catch (...) {
    say("something that is no std::exception");
  }
}

peerd_pose no_pose() {
  peerd_pose out{};
  std::ranges::fill(out.position, kNan);
  std::ranges::fill(out.orientation, kNan);
  return out;
}

}  // namespace

extern "C" {

const char* peerd_version(void) { return PEERD_VERSION; }

peerd_options* peerd_options_new(void) { return new peerd_options; }

void peerd_options_free(peerd_options* options) { delete options; }

int peerd_options_set(peerd_options* options, const char* name, const char* value) {
  return options->values.set(text_of(name), text_of(value)) ? 1 : 0;
}

void peerd_options_log(peerd_options* options, peerd_log log, void* user) {
  if (log == nullptr) {
    options->values.log_to = {};
    return;
  }
  options->values.log_to = [log, user](const LogLine& line) { give_line(log, user, line); };
}

peerd_peer* peerd_open(const peerd_options* options, char* error, size_t size) {
  const auto fail = [&](std::string_view why) -> peerd_peer* {
    if (error != nullptr && size > 0) {
      const std::size_t length = std::min(why.size(), size - 1);
      std::memcpy(error, why.data(), length);
      error[length] = '\0';
    }
    return nullptr;
  };
  try {
    const auto given = options->values.peer_options();
    if (!given) return fail(given.error().text);
    auto peer = EmbeddedPeer::open(*given);
    if (!peer) return fail(peer.error().text);
    return reinterpret_cast<peerd_peer*>(peer->release());
  } catch (const std::exception& thrown) {
    return fail(thrown.what());
  }
}

void peerd_close(peerd_peer* peer) {
  // The destructors of a peer of another process would unregister sockets, end the store's log and wait for a thread,
  // all of which are that process's: its memory stays.
  if (peer == nullptr || is_of_another_process(peer)) return;
  delete &peer_of(peer);
}

const char* peerd_error(peerd_peer* peer) {
  if (is_of_another_process(peer)) return kOfAnotherProcess;
  return with(peer, "", [](EmbeddedPeer& held) { return held.error.c_str(); });
}

int peerd_poll(peerd_peer* handle, double at_most_s) {
  return with(handle, 0, [&](EmbeddedPeer& peer) {
    if (peer.has_thread()) {
      peer.error = "the peer has a thread of its own";
      return 0;
    }
    return peer.poll(from_seconds(std::clamp(at_most_s, 0.0, 3600.0))) ? 1 : 0;
  });
}

int peerd_start(peerd_peer* peer) {
  if (is_of_another_process(peer)) return 0;
  if (peer_of(peer).start()) return 1;
  peer_of(peer).error = "the peer has a thread already";
  return 0;
}

void peerd_hold(peerd_peer* peer) {
  if (!is_of_another_process(peer)) peer_of(peer).hold();
}

void peerd_unhold(peerd_peer* peer) {
  if (!is_of_another_process(peer)) peer_of(peer).release();
}

void peerd_leave(peerd_peer* peer) {
  with(peer, 0, [](EmbeddedPeer& held) {
    held.leave();
    return 1;
  });
}

int peerd_has_left(peerd_peer* peer) {
  return with(peer, 1, [](EmbeddedPeer& held) { return held.has_left() ? 1 : 0; });
}

uint32_t peerd_id(peerd_peer* peer) {
  return with(peer, 0U, [](EmbeddedPeer& held) { return held.node().peer().id().value; });
}

int peerd_in_session(peerd_peer* peer) {
  return with(peer, 0, [](EmbeddedPeer& held) { return held.node().peer().clock().synchronised() ? 1 : 0; });
}

double peerd_session_time(peerd_peer* peer) {
  return with(peer, kNan, [](EmbeddedPeer& held) {
    const auto now = held.session_now();
    return now ? to_seconds(now->time_since_epoch()) : kNan;
  });
}

size_t peerd_member_count(peerd_peer* peer) {
  return with(peer, std::size_t{0}, [](EmbeddedPeer& held) { return held.node().peer().members().count(); });
}

peerd_object peerd_find(peerd_peer* peer, const char* path) {
  return with(peer, PEERD_NO_OBJECT, [&](EmbeddedPeer& held) {
    const auto found = held.node().scene().find(text_of(path));
    if (!found) held.error = "there is no object \"" + text_of(path) + "\"";
    return found ? found->packed() : PEERD_NO_OBJECT;
  });
}

const char* peerd_path(peerd_peer* peer, peerd_object object) {
  return with(peer, static_cast<const char*>(nullptr), [&](EmbeddedPeer& held) -> const char* {
    auto path = path_in(held, object);
    if (!path) return nullptr;
    held.text = *std::move(path);
    return held.text.c_str();
  });
}

uint32_t peerd_owner(peerd_peer* peer, peerd_object object) {
  return with(peer, 0U, [&](EmbeddedPeer& held) {
    const ObjectId id = ObjectId::unpacked(object);
    if (object == PEERD_NO_OBJECT || !held.node().scene().contains(id)) return 0U;
    return held.node().peer().owner(id).value;
  });
}

size_t peerd_owned_objects(peerd_peer* peer, peerd_object* out, size_t room) {
  return with(peer, std::size_t{0}, [&](EmbeddedPeer& held) {
    std::size_t count = 0;
    for (const auto& [object, owner] : held.node().peer().owners()) {
      if (count < room) out[count] = object.packed();
      ++count;
    }
    return count;
  });
}

const char* peerd_world(peerd_peer* peer) {
  return with(peer, static_cast<const char*>(nullptr), [&](EmbeddedPeer& held) -> const char* {
    const json reply = asked(held, {{"do", "world"}});
    if (reply.is_discarded()) return nullptr;
    held.text = reply.value("world", "");
    return held.text.c_str();
  });
}

size_t peerd_poses(peerd_peer* peer, const peerd_object* objects, size_t count, peerd_pose* out) {
  return with(peer, std::size_t{0}, [&](EmbeddedPeer& held) {
    const auto now = held.look();
    const Scene& scene = held.node().scene();
    std::size_t found = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const ObjectId object = ObjectId::unpacked(objects[i]);
      const bool is_there = now && objects[i] != PEERD_NO_OBJECT && scene.contains(object);
      out[i] = is_there ? pose_of(held.shown(object, *now)) : no_pose();
      found += is_there ? 1 : 0;
    }
    return found;
  });
}

int peerd_take(peerd_peer* peer, peerd_object object) {
  return edited(
      peer, [&](EmbeddedPeer& held) { return about(held, "grab", object); }, nullptr);
}

int peerd_release(peerd_peer* peer, peerd_object object) {
  return edited(
      peer, [&](EmbeddedPeer& held) { return about(held, "release", object); }, nullptr);
}

size_t peerd_move(peerd_peer* peer, const peerd_motion* motions, size_t count) {
  return with(peer, std::size_t{0}, [&](EmbeddedPeer& held) { return held.move({motions, count}); });
}

int peerd_add(peerd_peer* peer, peerd_object under, const char* vrml, peerd_operation* operation) {
  const auto request = [&](EmbeddedPeer& held) { return below(held, {{"do", "add"}, {"text", text_of(vrml)}}, under); };
  return edited(peer, request, operation);
}

int peerd_remove(peerd_peer* peer, peerd_object object, peerd_operation* operation) {
  return edited(
      peer, [&](EmbeddedPeer& held) { return about(held, "remove", object); }, operation);
}

int peerd_reparent(peerd_peer* peer, peerd_object object, peerd_object under, peerd_operation* operation) {
  return edited(
      peer, [&](EmbeddedPeer& held) { return below(held, about(held, "move", object), under); }, operation);
}

int peerd_set(peerd_peer* peer, const char* path, const char* field, const char* value, peerd_operation* operation) {
  json request{{"do", "set"}, {"path", text_of(path)}, {"field", text_of(field)}, {"value", text_of(value)}};
  return edited(
      peer, [&](EmbeddedPeer&) { return request; }, operation);
}

int peerd_set_data(peerd_peer* peer, const char* path, const char* key, const char* value, peerd_operation* operation) {
  return peerd_set_sized_data(peer, path, key, value, value == nullptr ? 0 : std::strlen(value), operation);
}

int peerd_set_sized_data(peerd_peer* peer, const char* path, const char* key, const char* value, size_t size,
                         peerd_operation* operation) {
  json request{{"do", "data"}, {"path", text_of(path)}, {"key", text_of(key)}};
  if (value == nullptr) {
    request["remove"] = true;
  } else {
    request["value"] = std::string(value, size);
  }
  return edited(
      peer, [&](EmbeddedPeer&) { return request; }, operation);
}

const char* peerd_data(peerd_peer* peer, const char* path, const char* key) {
  return peerd_sized_data(peer, path, key, nullptr);
}

const char* peerd_sized_data(peerd_peer* peer, const char* path, const char* key, size_t* size) {
  if (size != nullptr) *size = 0;
  return with(peer, static_cast<const char*>(nullptr), [&](EmbeddedPeer& held) -> const char* {
    const json reply = asked(held, {{"do", "data"}, {"path", text_of(path)}, {"key", text_of(key)}});
    if (reply.is_discarded() || !reply.contains("value") || !reply["value"].is_string()) return nullptr;
    held.text = reply["value"].get<std::string>();
    if (size != nullptr) *size = held.text.size();
    return held.text.c_str();
  });
}

int peerd_send(peerd_peer* peer, const char* topic, const char* text, peerd_operation* operation) {
  json request{{"do", "send"}, {"topic", text_of(topic)}, {"text", text_of(text)}};
  return edited(
      peer, [&](EmbeddedPeer&) { return request; }, operation);
}

int peerd_undo(peerd_peer* peer, peerd_operation* operation) {
  return edited(
      peer,
      [](EmbeddedPeer&) {
        return json{{"do", "undo"}};
      },
      operation);
}

int peerd_redo(peerd_peer* peer, peerd_operation* operation) {
  return edited(
      peer,
      [](EmbeddedPeer&) {
        return json{{"do", "redo"}};
      },
      operation);
}

const char* peerd_ask(peerd_peer* peer, const char* request) {
  return with(peer, static_cast<const char*>(nullptr), [&](EmbeddedPeer& held) {
    held.text = held.ask(text_of(request));
    return held.text.c_str();
  });
}

int peerd_next_event(peerd_peer* peer, peerd_event* event, size_t size) {
  return with(peer, 0, [&](EmbeddedPeer& held) {
    auto next = held.next_event();
    if (!next) return 0;
    held.event = *std::move(next);
    held.event.event.name = held.event.name ? held.event.name->c_str() : nullptr;
    held.event.event.text = held.event.text ? held.event.text->c_str() : nullptr;
    held.event.event.path = held.event.path ? held.event.path->c_str() : nullptr;
    std::memset(event, 0, size);
    std::memcpy(event, &held.event.event, std::min(size, sizeof(peerd_event)));
    return 1;
  });
}

int peerd_event_descriptor(peerd_peer* peer) {
  return is_of_another_process(peer) ? -1 : peer_of(peer).signal().descriptor();
}

}  // extern "C"
