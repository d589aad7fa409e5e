// watch WORLD COUNT SAMPLES [NAME VALUE]..: joins the world of that name, waits until others own COUNT objects in it,
// and prints SAMPLES times where these are: session time, path, x, y, z.
#include <chrono>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <peerd/peerd.hpp>
#include <string>
#include <vector>

using namespace peerd::embed;

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  try {
    Options options;
    options.set("join", argv[1]).set("name", "watch");
    for (int i = 4; i + 1 < argc; i += 2) options.set(argv[i], argv[i + 1]);
    Peer peer(options);
    std::vector<Object> objects;
    while (objects.size() < std::strtoul(argv[2], nullptr, 10) || !peer.in_session()) {
      if (!peer.poll(0.01)) return 1;
      objects = peer.owned_objects();
    }
    std::vector<peerd_pose> poses(objects.size());
    std::cout << std::fixed << std::setprecision(9);
    for (int sample = std::atoi(argv[3]); sample > 0; --sample) {
      const auto next = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
      while (std::chrono::steady_clock::now() < next) {
        if (!peer.poll(0.002)) return 1;
      }
      const double before = peer.session_time().value();
      peer.poses(objects.data(), objects.size(), poses.data());
      const double now = (before + peer.session_time().value()) / 2.0;
      for (std::size_t i = 0; i < objects.size(); ++i) {
        const auto& [x, y, z] = poses[i].position;
        std::cout << now << ' ' << peer.path(objects[i]).value_or("?") << ' ' << x << ' ' << y << ' ' << z << '\n';
      }
    }
  } catch (const std::exception& error) {
    std::cerr << "watch: " << error.what() << '\n';
    return 1;
  }
}
