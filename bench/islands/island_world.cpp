#include "island_world.hpp"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace peerd::bench {
namespace {

std::string object_name(std::uint32_t peer, std::uint32_t number) { return fmt::format("O_{:05}_{:03}", peer, number); }
std::string peer_name(std::uint32_t peer) { return fmt::format("p{:05}", peer); }

}  // namespace

std::uint32_t IslandWorld::side() const {
  return static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(peers))));
}

double IslandWorld::joined_s() const {
  return peers <= together ? 0.0 : 1.0 + static_cast<double>(peers - together) / joins_per_s;
}

std::string world_text(const IslandWorld& world) {
  std::string text = "#VRML V2.0 utf8\n";
  for (std::uint32_t peer = 0; peer < world.peers; ++peer) {
    const std::uint32_t column = peer % world.side(), row = peer / world.side();
    for (std::uint32_t k = 0; k < world.objects; ++k) {
      text +=
          fmt::format("DEF {} Transform {{ translation {} 0 {} children Shape {{ geometry Box {{ size 1 1 1 }} }} }}\n",
                      object_name(peer, k), kSquare_m * (column + 0.5), kSquare_m * (row + 0.5));
    }
  }
  // The first objects of two neighbours meet on the border between their squares.
  for (std::uint32_t peer = 0; peer + 1 < world.peers; ++peer) {
    if ((peer + 1) % world.side() == 0) continue;
    text += fmt::format("CollisionInterest {{ objectPath \"{}\" interests \"{}\" }}\n", object_name(peer, 0),
                        object_name(peer + 1, 0));
  }
  return text;
}

std::string scenario_text(const IslandWorld& world, const std::string& world_file) {
  std::string text = fmt::format(
      "world = \"{}\"\nduration_s = {}\nsample_hz = 1\n[replication]\ntick_hz = 30\nerror_threshold_m = 0.25\n"
      "[regions]\ncell_m = {}\ncounts = [{}, 1, {}]\n"
      "[network]\nlatency_ms = 60\njitter_ms = 10\nloss = 0.005\n",
      world_file, world.duration_s(), kSquare_m, world.side(), world.side());
  for (std::uint32_t island = 0; island < std::min(world.islands, world.peers); ++island) {
    text += "[[network.island]]\nlatency_ms = 2\njitter_ms = 1\nloss = 0\npeers = [";
    for (std::uint32_t peer = island; peer < world.peers; peer += world.islands) {
      text += fmt::format("\"{}\", ", peer_name(peer));
    }
    text += "]\n";
  }
  // Object k of peer p has the number p * objects + k. The first of each peer goes to and fro between the neighbours to
  // the left and to the right, every other peer's the other way; the others wander about, 3 m beyond the borders.
  text += fmt::format(
      "[motion.\"O_*\"]\n"
      "define = [\"p = floor(n/{0})\", \"k = n - {0}*p\", \"column = mod(p, {1})\", \"row = floor(p/{1})\", "
      "\"way = 1 - 2*mod(column, 2)\"]\n"
      "x = \"{2}*(column + 0.5) + (k == 0 ? way*24.8*sin(0.3142*t) : 28*sin((0.05 + 0.003*k)*t + 1.7*n))\"\n"
      "z = \"{2}*(row + 0.5) + (k == 0 ? 0 : 28*sin((0.1 - 0.002*k)*t + 2.9*n))\"\n",
      world.objects, world.side(), kSquare_m);
  for (std::uint32_t peer = 0; peer < world.peers; ++peer) {
    text += fmt::format("[peer.{}]\nid = {}\nowns = [\"O_{:05}_*\"]\ninterest_radius_m = 20\n", peer_name(peer),
                        peer + 1, peer);
    if (peer < world.together) continue;
    text += fmt::format("[event.{0}]\nkind = \"join\"\npeer = \"{0}\"\nat_s = {1}\n", peer_name(peer),
                        1.0 + static_cast<double>(peer - world.together) / world.joins_per_s);
  }
  return text;
}

}  // namespace peerd::bench
