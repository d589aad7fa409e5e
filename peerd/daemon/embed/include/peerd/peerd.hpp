// A peer of a shared world inside a program: the C++17 interface of libpeerd, over the C interface, peerd.h, which says
// what each function means. It needs no other header.
//
//   using namespace peerd::embed;
//   Peer peer(Options().set("world", "town.wrl").set("name", "ada").set("own", "CAR"));
//   const Object car = peer.find("CAR").value();
//   peer.take(car);
//   while (peer.poll(0.005)) {
//     peer.move(car, my_pose());
//     while (const auto event = peer.next_event()) ..
//   }
//
// Errors throw peerd::embed::Error; questions that are often asked in vain return an optional. All texts are copies. In
// a child of fork() all functions of a Peer throw, and its destructor does nothing.
#ifndef PEERD_HPP
#define PEERD_HPP

#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "peerd.h"

namespace peerd::embed {

class Error : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

namespace detail {

// A text of C ends at its first zero byte.
inline const char* c_text(const std::string& text) {
  if (text.find('\0') != std::string::npos) throw Error("a text has a zero byte; data's values alone may have some");
  return text.c_str();
}

}  // namespace detail

using Vector = std::array<double, 3>;      // x, y, z
using Quaternion = std::array<double, 4>;  // x, y, z, w; turns the object's axes into the world's

struct Pose {
  Vector position{};  // [m]
  Quaternion orientation{0, 0, 0, 1};
};

// An instance of a node of the scene, the same at all peers.
using Object = peerd_object;
using Operation = peerd_operation;

struct Event {
  peerd_event_kind kind{};
  double time = 0.0;  // session time [s]
  std::uint32_t peer = 0;
  Object object = 0, other = 0;
  // A contact's: where both were, their velocities [m/s], the normal of the other's surface, which faces object.
  Pose pose{}, other_pose{};
  Vector velocity_before{}, velocity_after{}, other_velocity_before{}, other_velocity_after{};
  Vector normal{};
  Operation operation{};
  std::optional<std::string> name{}, text{}, path{};
  std::uint64_t count = 0;
};

// Options open a peer, by the names that peerd_options_set() knows.
class Options {
 public:
  Options& set(const std::string& name, const std::string& value) {
    if (!peerd_options_set(options_.get(), detail::c_text(name), detail::c_text(value))) {
      throw Error("there is no option " + name + ", or it does not take \"" + value + "\"");
    }
    return *this;
  }
  // Lines of the log go there, from debug (0) to error (3); peerd_options_log() says what it may do.
  using Log = std::function<void(int level, const std::string& text)>;
  Options& log_to(Log log) {
    log_ = std::make_shared<Log>(std::move(log));
    peerd_options_log(
        options_.get(), [](void* user, int level, const char* text) { (*static_cast<Log*>(user))(level, text); },
        log_.get());
    return *this;
  }

 private:
  friend class Peer;
  std::shared_ptr<peerd_options> options_{peerd_options_new(), peerd_options_free};
  std::shared_ptr<Log> log_{};
};

class Peer {
 public:
  explicit Peer(const Options& options) : log_(options.log_) {
    std::array<char, 1024> why{};
    peer_.reset(peerd_open(options.options_.get(), why.data(), why.size()));
    if (!peer_) throw Error(why.data());
  }

  // For functions of the C interface; the peer stays this object's.
  peerd_peer* handle() const {
    if (getpid() == opened_in_) return peer_.get();
    throw Error("the peer belongs to another process, from which this one was forked; open one here");
  }

  // -- driving
  bool poll(double at_most_s) { return peerd_poll(handle(), at_most_s) != 0; }
  void start() {
    if (!peerd_start(handle())) fail();
  }
  void leave() { peerd_leave(handle()); }
  bool has_left() const { return peerd_has_left(handle()) != 0; }

  // Keeps the peer's thread, and other threads' calls, waiting for as long as it lives.
  class Hold {
   public:
    explicit Hold(const Peer& peer) : peer_(peer.handle()) { peerd_hold(peer_); }
    ~Hold() { peerd_unhold(peer_); }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    peerd_peer* peer_;
  };

  // -- the session
  std::uint32_t id() const { return peerd_id(handle()); }
  bool in_session() const { return peerd_in_session(handle()) != 0; }
  std::optional<double> session_time() const {
    const double now = peerd_session_time(handle());
    return std::isnan(now) ? std::nullopt : std::optional(now);
  }
  std::size_t member_count() const { return peerd_member_count(handle()); }

  // -- what there is
  std::optional<Object> find(const std::string& path) const {
    const Object found = peerd_find(handle(), detail::c_text(path));
    return found == PEERD_NO_OBJECT ? std::nullopt : std::optional(found);
  }
  std::optional<std::string> path(Object object) const {
    const Hold held(*this);
    return optional(peerd_path(handle(), object));
  }
  std::uint32_t owner(Object object) const { return peerd_owner(handle(), object); }
  std::vector<Object> owned_objects() const {
    std::vector<Object> all;
    for (std::size_t count = peerd_owned_objects(handle(), nullptr, 0); count > all.size();) {
      all.resize(count);
      count = peerd_owned_objects(handle(), all.data(), all.size());
      if (count < all.size()) all.resize(count);
    }
    return all;
  }
  std::string world() const {
    const Hold held(*this);
    return text(peerd_world(handle()));
  }

  // -- where it is
  std::optional<Pose> pose(Object object) const {
    peerd_pose out{};
    if (peerd_poses(handle(), &object, 1, &out) == 0) return std::nullopt;
    return from(out);
  }
  // NaN where there is no such object. Returns how many there are.
  std::size_t poses(const Object* objects, std::size_t count, peerd_pose* out) const {
    return peerd_poses(handle(), objects, count, out);
  }

  // -- moving what this peer owns
  void take(Object object) {
    const Hold held(*this);
    check(peerd_take(handle(), object));
  }
  void release(Object object) {
    const Hold held(*this);
    check(peerd_release(handle(), object));
  }
  // False: this program may not move it, now.
  bool move(Object object, const Pose& pose, const std::optional<Vector>& velocity = {}, bool jumps = false) {
    peerd_motion motion{};
    motion.object = object;
    motion.jumps = jumps ? 1 : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      motion.pose.position[i] = pose.position[i];
      motion.velocity[i] = velocity ? (*velocity)[i] : std::numeric_limits<double>::quiet_NaN();
    }
    for (std::size_t i = 0; i < 4; ++i) motion.pose.orientation[i] = pose.orientation[i];
    return move(&motion, 1) == 1;
  }
  std::size_t move(const peerd_motion* motions, std::size_t count) { return peerd_move(handle(), motions, count); }

  // -- changing the world
  Operation add(const std::string& vrml, Object under = PEERD_NO_OBJECT) {
    return edit([&](peerd_operation* o) { return peerd_add(handle(), under, detail::c_text(vrml), o); });
  }
  Operation remove(Object object) {
    return edit([&](peerd_operation* o) { return peerd_remove(handle(), object, o); });
  }
  Operation reparent(Object object, Object under) {
    return edit([&](peerd_operation* o) { return peerd_reparent(handle(), object, under, o); });
  }
  Operation set(const std::string& path, const std::string& field, const std::string& value) {
    return edit([&](peerd_operation* o) {
      return peerd_set(handle(), detail::c_text(path), detail::c_text(field), detail::c_text(value), o);
    });
  }
  // No value: the key is removed.
  Operation set_data(const std::string& path, const std::string& key, const std::optional<std::string>& value) {
    return edit([&](peerd_operation* o) {
      return peerd_set_sized_data(handle(), detail::c_text(path), detail::c_text(key), value ? value->data() : nullptr,
                                  value ? value->size() : 0, o);
    });
  }
  std::optional<std::string> data(const std::string& path, const std::string& key) const {
    const Hold held(*this);
    std::size_t size = 0;
    const char* const value = peerd_sized_data(handle(), detail::c_text(path), detail::c_text(key), &size);
    return value == nullptr ? std::nullopt : std::optional<std::string>(std::in_place, value, size);
  }
  Operation send(const std::string& topic, const std::string& message) {
    return edit(
        [&](peerd_operation* o) { return peerd_send(handle(), detail::c_text(topic), detail::c_text(message), o); });
  }
  Operation undo() {
    return edit([&](peerd_operation* o) { return peerd_undo(handle(), o); });
  }
  Operation redo() {
    return edit([&](peerd_operation* o) { return peerd_redo(handle(), o); });
  }
  std::string ask(const std::string& request) {
    const Hold held(*this);
    return text(peerd_ask(handle(), detail::c_text(request)));
  }

  // -- events
  std::optional<Event> next_event() {
    const Hold held(*this);
    peerd_event next{};
    if (!peerd_next_event(handle(), &next, sizeof(next))) return std::nullopt;
    Event event;
    event.kind = static_cast<peerd_event_kind>(next.kind);
    event.time = next.time;
    event.peer = next.peer;
    event.object = next.object;
    event.other = next.other;
    event.pose = from(next.pose);
    event.other_pose = from(next.other_pose);
    for (std::size_t i = 0; i < 3; ++i) {
      event.velocity_before[i] = next.velocity_before[i];
      event.velocity_after[i] = next.velocity_after[i];
      event.other_velocity_before[i] = next.other_velocity_before[i];
      event.other_velocity_after[i] = next.other_velocity_after[i];
      event.normal[i] = next.normal[i];
    }
    event.operation = next.operation;
    event.name = optional(next.name);
    event.text = optional(next.text);
    event.path = optional(next.path);
    event.count = next.count;
    return event;
  }
  int event_descriptor() const { return peerd_event_descriptor(handle()); }

 private:
  struct Close {
    void operator()(peerd_peer* peer) const { peerd_close(peer); }
  };
  static Pose from(const peerd_pose& pose) {
    Pose out;
    for (std::size_t i = 0; i < 3; ++i) out.position[i] = pose.position[i];
    for (std::size_t i = 0; i < 4; ++i) out.orientation[i] = pose.orientation[i];
    return out;
  }
  static std::optional<std::string> optional(const char* text) {
    return text == nullptr ? std::nullopt : std::optional<std::string>(text);
  }
  [[noreturn]] void fail() const {
    const Hold held(*this);
    throw Error(peerd_error(handle()));
  }
  std::string text(const char* text) const {
    if (text == nullptr) fail();
    return text;
  }
  void check(int done) const {
    if (!done) fail();
  }
  template <class Edit>
  Operation edit(Edit&& edit) const {
    const Hold held(*this);
    Operation operation{};
    check(edit(&operation));
    return operation;
  }

  pid_t opened_in_ = getpid();
  std::shared_ptr<Options::Log> log_;  // outlives the peer
  std::unique_ptr<peerd_peer, Close> peer_;
};

}  // namespace peerd::embed

#endif
