// The compiled part of the Python package: the C++ interface of libpeerd, with numpy's arrays in place of pointers.
// Every call goes on without the interpreter's lock, which the peer's thread needs for lines of the log.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <peerd/peerd.hpp>
#include <string>
#include <vector>

namespace py = pybind11;
using namespace peerd::embed;

namespace {

constexpr py::ssize_t kPoseColumns = 7, kVelocityColumns = 3;
static_assert(sizeof(peerd_pose) == kPoseColumns * sizeof(double));

using Objects = py::array_t<Object, py::array::c_style | py::array::forcecast>;
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using OwnNumbers = py::array_t<double, py::array::c_style>;  // no copy: it is written to

Objects owned_objects(const Peer& peer) {
  auto owned = [&] {
    const py::gil_scoped_release others_may_run;
    return std::make_unique<std::vector<Object>>(peer.owned_objects());
  }();
  const Object* const first = owned->data();
  const auto count = static_cast<py::ssize_t>(owned->size());
  const py::capsule owner(owned.release(), [](void* of) { delete static_cast<std::vector<Object>*>(of); });
  return Objects(count, first, owner);
}

// Throws where the array is none of so many rows and columns.
void check_shape(const py::array& array, py::ssize_t rows, py::ssize_t columns, const char* name) {
  if (array.ndim() == 2 && array.shape(0) == rows && array.shape(1) == columns) return;
  throw py::value_error(std::string(name) + " must have " + std::to_string(rows) + " rows of " +
                        std::to_string(columns) + " numbers");
}

std::size_t poses(const Peer& peer, const Objects& objects, OwnNumbers& out) {
  check_shape(out, objects.size(), kPoseColumns, "out");
  auto* const rows = reinterpret_cast<peerd_pose*>(out.mutable_data());
  const Object* const first = objects.data();
  const auto count = static_cast<std::size_t>(objects.size());
  const py::gil_scoped_release others_may_run;
  return peer.poses(first, count, rows);
}

std::size_t move(Peer& peer, const Objects& objects, const Numbers& poses, const std::optional<Numbers>& velocities,
                 bool jumps) {
  check_shape(poses, objects.size(), kPoseColumns, "poses");
  if (velocities) check_shape(*velocities, objects.size(), kVelocityColumns, "velocities");
  // A thread keeps its memory: that of 10,000 objects is a megabyte, to be had from the system each time.
  static thread_local std::vector<peerd_motion> motions;
  motions.resize(static_cast<std::size_t>(objects.size()));
  const double* const rows = poses.data();
  const double* const speeds = velocities ? velocities->data() : nullptr;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    peerd_motion& motion = motions[i];
    motion.object = objects.data()[i];
    std::memcpy(&motion.pose, rows + i * kPoseColumns, sizeof(motion.pose));
    for (std::size_t k = 0; k < kVelocityColumns; ++k) {
      motion.velocity[k] =
          speeds != nullptr ? speeds[i * kVelocityColumns + k] : std::numeric_limits<double>::quiet_NaN();
    }
    motion.jumps = jumps ? 1 : 0;
  }
  const py::gil_scoped_release others_may_run;
  return peer.move(motions.data(), motions.size());
}

// A peer's thread may want the interpreter's lock for its last lines.
struct Close {
  void operator()(Peer* peer) const {
    const py::gil_scoped_release others_may_run;
    delete peer;
  }
};

using Call = py::call_guard<py::gil_scoped_release>;

}  // namespace

PYBIND11_MODULE(_peerd, module) {
  module.doc() = "The compiled part of peerd.";
  module.attr("NO_OBJECT") = PEERD_NO_OBJECT;
  module.def("version", [] { return std::string(peerd_version()); });
  py::register_exception<Error>(module, "Error", PyExc_RuntimeError);

  py::class_<Operation>(module, "Operation")
      .def_readonly("author", &Operation::author)
      .def_readonly("number", &Operation::number)
      .def("__repr__", [](const Operation& o) {
        return "Operation(" + std::to_string(o.author) + ":" + std::to_string(o.number) + ")";
      });
  py::enum_<peerd_event_kind>(module, "EventKind")
      .value("PEER_JOINED", PEERD_PEER_JOINED)
      .value("PEER_LEFT", PEERD_PEER_LEFT)
      .value("CONTACT", PEERD_CONTACT)
      .value("OBJECT_GIVEN", PEERD_OBJECT_GIVEN)
      .value("MESSAGE", PEERD_MESSAGE)
      .value("DATA", PEERD_DATA)
      .value("EDIT", PEERD_EDIT)
      .value("EVENTS_LOST", PEERD_EVENTS_LOST)
      .value("CONTACT_OVERRULED", PEERD_CONTACT_OVERRULED);
  py::class_<Pose>(module, "Pose")
      .def_readonly("position", &Pose::position)
      .def_readonly("orientation", &Pose::orientation);
  py::class_<Event>(module, "Event")
      .def_readonly("kind", &Event::kind)
      .def_readonly("time", &Event::time)
      .def_readonly("peer", &Event::peer)
      .def_readonly("object", &Event::object)
      .def_readonly("other", &Event::other)
      .def_readonly("pose", &Event::pose)
      .def_readonly("other_pose", &Event::other_pose)
      .def_readonly("velocity_before", &Event::velocity_before)
      .def_readonly("velocity_after", &Event::velocity_after)
      .def_readonly("other_velocity_before", &Event::other_velocity_before)
      .def_readonly("other_velocity_after", &Event::other_velocity_after)
      .def_readonly("normal", &Event::normal)
      .def_readonly("operation", &Event::operation)
      .def_readonly("name", &Event::name)
      .def_readonly("text", &Event::text)
      .def_readonly("path", &Event::path)
      .def_readonly("count", &Event::count);
  py::class_<Options>(module, "Options")
      .def(py::init<>())
      .def("set", [](Options& options, const std::string& name, const std::string& value) { options.set(name, value); })
      .def("log_to", [](Options& options, const Options::Log& log) {
        // An exception has nobody to go to: the interpreter says it as it does those of other callbacks.
        options.log_to([log](int level, const std::string& text) {
          const py::gil_scoped_acquire held;
          try {
            log(level, text);
          } catch (py::error_already_set& raised) {
            raised.discard_as_unraisable("the log of a peer");
          }
        });
      });

  py::class_<Peer, std::unique_ptr<Peer, Close>>(module, "Peer")
      .def(py::init<const Options&>(), Call())
      .def("handle", [](const Peer& peer) { return reinterpret_cast<std::uintptr_t>(peer.handle()); })
      .def(
          "hold", [](const Peer& peer) { peerd_hold(peer.handle()); }, Call())
      .def(
          "end_hold",
          [](const Peer& peer) {
            try {
              peerd_unhold(peer.handle());
            } catch (const Error&) {  // a child of fork() ends its parent's hold
            }
          },
          Call())
      .def("event_descriptor", &Peer::event_descriptor)
      .def("has_left", &Peer::has_left, Call())
      .def("poll", &Peer::poll, py::arg("at_most_s"), Call())
      .def("start", &Peer::start, Call())
      .def("leave", &Peer::leave, Call())
      .def("id", &Peer::id, Call())
      .def("in_session", &Peer::in_session, Call())
      .def("session_time", &Peer::session_time, Call())
      .def("member_count", &Peer::member_count, Call())
      .def("find", &Peer::find, py::arg("path"), Call())
      .def("path", &Peer::path, py::arg("object"), Call())
      .def("owner", &Peer::owner, py::arg("object"), Call())
      .def("owned_objects", &owned_objects)
      .def("world", &Peer::world, Call())
      .def("poses", &poses, py::arg("objects"), py::arg("out").noconvert())
      .def("take", &Peer::take, py::arg("object"), Call())
      .def("release", &Peer::release, py::arg("object"), Call())
      .def("move", &move, py::arg("objects"), py::arg("poses"), py::arg("velocities"), py::arg("jumps"))
      .def("add", &Peer::add, py::arg("vrml"), py::arg("under"), Call())
      .def("remove", &Peer::remove, py::arg("object"), Call())
      .def("reparent", &Peer::reparent, py::arg("object"), py::arg("under"), Call())
      .def("set", &Peer::set, py::arg("path"), py::arg("field"), py::arg("value"), Call())
      .def("set_data", &Peer::set_data, py::arg("path"), py::arg("key"), py::arg("value"), Call())
      .def("data", &Peer::data, py::arg("path"), py::arg("key"), Call())
      .def("send", &Peer::send, py::arg("topic"), py::arg("message"), Call())
      .def("undo", &Peer::undo, Call())
      .def("redo", &Peer::redo, Call())
      .def("ask", &Peer::ask, py::arg("request"), Call())
      .def("next_event", &Peer::next_event, Call());
}
