// A program of somebody else's: reads a world, asks when two of its objects meet, and starts a peer of its own.
#include <fstream>
#include <iostream>
#include <sstream>

#include "collision/contact/contact_time.hpp"
#include "core/scene/reader.hpp"
#include "replication/peer/peer.hpp"

int main(int, char** argv) {
  std::ifstream file(argv[1]);
  std::ostringstream text;
  text << file.rdbuf();
  const std::string bytes = text.str();
  const peerd::ReadResult world = peerd::read_world(bytes);
  if (!world.scene) return 1;

  const auto car = world.scene->find("CAR"), wall = world.scene->find("WALL_RIGHT");
  if (!car || !wall) return 1;
  const auto car_body = peerd::collision::make_body(*world.scene, *car);
  const auto wall_body = peerd::collision::make_body(*world.scene, *wall);
  peerd::KinematicState driving = peerd::at_rest(world.scene->rigid_pose(*car));
  driving.velocity.x() = 1.0;
  const peerd::KinematicState standing = peerd::at_rest(world.scene->rigid_pose(*wall));
  const auto contact =
      peerd::collision::first_contact({car_body, driving}, {wall_body, standing}, peerd::CollisionType::kWitness, 60.0);
  std::cout << "the car meets the wall after " << contact.time_s << " s\n";

  const auto model = peerd::replication::make_world_model(*world.scene);
  peerd::replication::PeerConfig config;
  config.name = "outside";
  peerd::replication::Peer peer(config, *model);
  peer.on_tick(peerd::HostTime{}, {});
  return contact.state == peerd::collision::ContactState::kContact && peer.poll_output() ? 0 : 1;
}
