// meet WORLD OWN [NAME VALUE]..: the same as meet.c, in C++, and with a thread that runs the peer.
#include <chrono>
#include <iostream>
#include <optional>
#include <peerd/peerd.hpp>
#include <string>
#include <thread>

using namespace peerd::embed;

namespace {

constexpr double kSpeed = 1.5;  // [m/s]

// Until both balls have an owner who is here.
void wait_for_other(const Peer& peer, Object own, Object other) {
  while (!peer.in_session() || peer.member_count() == 0 || peer.owner(own) != peer.id() || peer.owner(other) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void meet(Peer& peer, const std::string& name) {
  const bool is_left = name == "LEFT";
  const Object own = peer.find(name).value(), other = peer.find(is_left ? "RIGHT" : "LEFT").value();
  peer.start();
  wait_for_other(peer, own, other);
  peer.take(own);
  const double began = peer.session_time().value(), speed = is_left ? kSpeed : -kSpeed;
  for (;;) {
    const double x = (is_left ? -4.0 : 4.0) + speed * (peer.session_time().value() - began);
    peer.move(own, Pose{{x, 0.0, 0.0}}, Vector{speed, 0.0, 0.0});
    while (const auto event = peer.next_event()) {
      if (event->kind != PEERD_CONTACT) continue;
      const double at = (event->pose.position[0] + event->other_pose.position[0]) / 2.0;
      const char* const decider = event->peer == peer.id() ? "this peer" : "the other peer";
      std::cout << name << " met the other ball at x = " << at << " m; " << decider << " has decided it\n";
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: meet WORLD LEFT|RIGHT [NAME VALUE]..\n";
    return 2;
  }
  try {
    Options options;
    options.set("world", argv[1]).set("own", argv[2]).set("name", argv[2]);
    for (int i = 3; i + 1 < argc; i += 2) options.set(argv[i], argv[i + 1]);
    Peer peer(options);
    meet(peer, argv[2]);
    std::this_thread::sleep_for(std::chrono::milliseconds(500));  // the other one is to hear of it, too
  } catch (const Error& error) {
    std::cerr << "meet: " << error.what() << '\n';
    return 1;
  }
}
