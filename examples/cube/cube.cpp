// cube WORLD OWN [NAME VALUE]..: drives one of the cubes of cube.wrl by hand, in a terminal: arrow keys or w, a, s, d
// push it, the space bar stops it, q ends. It prints what the cube touches, and stops it there.
//
// WORLD is a file (cube.wrl), or the name of a world that somebody else runs (cube), which needs no file. More options
// are those of peerd_options_set(). Keys may come from a file or a pipe, too.
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <iomanip>
#include <iostream>
#include <peerd/peerd.hpp>
#include <string>

using namespace peerd::embed;

namespace {

constexpr double kSpeed = 2.0;     // [m/s], of a cube that is pushed
constexpr double kPushed_s = 0.2;  // A terminal says that a key goes down, and repeats it, but not that it comes up.

// Keys without waiting for the end of a line, for as long as this lives.
class Terminal {
 public:
  Terminal() : is_terminal_(tcgetattr(STDIN_FILENO, &before_) == 0) {
    if (!is_terminal_) return;
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  ~Terminal() {
    if (is_terminal_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // The next key, q at the end of the input; 0: there is none now. Arrow keys are ESC [ A to D.
  char next_key() {
    for (;;) {
      pollfd input{STDIN_FILENO, POLLIN, 0};
      if (::poll(&input, 1, 0) <= 0) return 0;
      char key = 0;
      if (read(STDIN_FILENO, &key, 1) <= 0) return 'q';
      const bool is_arrow = seen_ == 2;
      seen_ = key == '\033' ? 1 : (seen_ == 1 && key == '[') ? 2 : 0;
      if (seen_ > 0) continue;
      if (!is_arrow) return key;
      if (key >= 'A' && key <= 'D') return "wsda"[key - 'A'];  // up, down, right, left
    }
  }

 private:
  termios before_{};
  bool is_terminal_;
  int seen_ = 0;  // of an arrow key: ESC, [
};

struct Cube {
  Object object = 0;
  Pose pose{};
  Vector velocity{};
  double pushed_until = 0.0;  // session time [s]
  Vector held_by{};           // the normal of what it touches, which it does not enter; zero: nothing
};

// The velocity that a key gives. Right is +x, and away from the person who looks is -z, as in VRML.
Vector velocity_of(char key) {
  switch (key) {
    case 'w':
      return {0, 0, -kSpeed};
    case 's':
      return {0, 0, kSpeed};
    case 'a':
      return {-kSpeed, 0, 0};
    case 'd':
      return {kSpeed, 0, 0};
    default:
      return {};
  }
}

// An object that a program moves does not answer a contact by itself, so the cube is put where it was at the contact.
void answer(const Peer& peer, Cube& cube, const Event& contact) {
  const bool is_first = contact.object == cube.object;
  if (!is_first && contact.other != cube.object) return;  // others have met
  const Object met = is_first ? contact.other : contact.object;
  std::cout << peer.path(cube.object).value_or("?") << " touches " << peer.path(met).value_or("?") << " of peer "
            << peer.owner(met) << " at " << contact.time << " s; peer " << contact.peer << " has found it" << std::endl;
  cube.pose = is_first ? contact.pose : contact.other_pose;
  for (int i = 0; i < 3; ++i) cube.held_by[i] = is_first ? contact.normal[i] : -contact.normal[i];
}

void move(Peer& peer, Cube& cube, double step_s) {
  double leaves = 0.0;
  for (int i = 0; i < 3; ++i) leaves += cube.held_by[i] * cube.velocity[i];
  if (leaves < 0.0) cube.velocity = {};
  if (leaves > 0.0) cube.held_by = {};
  for (int i = 0; i < 3; ++i) cube.pose.position[i] += cube.velocity[i] * step_s;
  peer.move(cube.object, cube.pose, cube.velocity);
}

// Asks for the cube until it is this peer's, which takes a moment. It can't be while another one drives it.
bool take(Peer& peer, Object object) {
  bool is_asked = false;
  while (peer.owner(object) != peer.id()) {
    if (!peer.poll(0.01)) return false;
    if (!is_asked && peer.in_session()) {
      peer.take(object);
      is_asked = true;
    }
  }
  return true;
}

void drive(Peer& peer, const std::string& own) {
  Cube cube;
  cube.object = peer.find(own).value();
  if (!take(peer, cube.object)) return;
  cube.pose = peer.pose(cube.object).value();
  std::cout << std::fixed << std::setprecision(3) << "peer " << peer.id() << " drives " << own << std::endl;
  Terminal terminal;
  double last = peer.session_time().value();
  while (peer.poll(0.005)) {
    const double now = peer.session_time().value();
    while (const char key = terminal.next_key()) {
      if (key == 'q') return;
      cube.velocity = velocity_of(key);
      cube.pushed_until = now + kPushed_s;
    }
    if (now > cube.pushed_until) cube.velocity = {};
    while (const auto event = peer.next_event()) {
      if (event->kind == PEERD_CONTACT) answer(peer, cube, *event);
    }
    move(peer, cube, now - last);
    last = now;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: cube WORLD OWN [NAME VALUE]..\n";
    return 2;
  }
  try {
    const std::string world = argv[1];
    const bool is_file = world.size() > 4 && world.substr(world.size() - 4) == ".wrl";
    Options options;
    options.set(is_file ? "world" : "join", world).set("name", argv[2]);
    for (int i = 3; i + 1 < argc; i += 2) options.set(argv[i], argv[i + 1]);
    Peer peer(options);
    drive(peer, argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "cube: " << error.what() << '\n';
    return 1;
  }
}
