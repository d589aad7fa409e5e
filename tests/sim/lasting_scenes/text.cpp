// A scene as VRML and TOML.
#include <array>
#include <sstream>

#include "tests/sim/lasting_scenes/scene.hpp"

namespace peerd::sim::lasting_scenes {
namespace {

std::ostringstream exact() {
  std::ostringstream out;
  out.precision(17);
  return out;
}

void put(std::ostream& out, const Vec3& v, const char* between) {
  out << v.x() << between << v.y() << between << v.z();
}

void put_parts(std::ostream& out, const Body& body) {
  out << "children [";
  for (const Part& part : body.parts) {
    const bool is_off = part.offset_m != Vec3::Zero();
    if (is_off) {
      out << " Transform { translation ";
      put(out, part.offset_m, " ");
      out << " children";
    }
    out << " Shape { geometry ";
    if (part.radius_m > 0.0) {
      out << "Sphere { radius " << part.radius_m << " } }";
    } else {
      out << "Box { size ";
      put(out, 2.0 * part.half_m, " ");
      out << " } }";
    }
    if (is_off) out << " }";
  }
  out << " ]";
}

void put_motion(std::ostream& out, const Body& body) {
  if (body.motion == Motion::kPhysics) {
    out << "physics = { velocity = [";
    put(out, body.velocity, ", ");
    out << "], acceleration = [";
    put(out, body.acceleration, ", ");
    out << ']';
    if (body.at_s > 0.0) out << ", at_s = " << body.at_s;
    out << " }\n";
  } else {
    out << "x = \"" << body.formula[0] << "\"\ny = \"" << body.formula[1] << "\"\nz = \"" << body.formula[2] << "\"\n";
    out << "axis = [";
    put(out, body.axis, ", ");
    out << "]\nangle = \"" << body.angle_rad << "\"\n";
  }
}

}  // namespace

std::string LastingScene::world() const {
  std::ostringstream out = exact();
  out << "#VRML V2.0 utf8\n";
  for (const Body& body : bodies) {
    out << "DEF " << body.name << " Transform { translation ";
    put(out, body.at, " ");
    if (body.angle_rad != 0.0) {
      out << " rotation ";
      put(out, body.axis, " ");
      out << ' ' << body.angle_rad;
    }
    out << " distanceThreshold " << threshold_m << ' ';
    if (body.motion == Motion::kPhysics) {
      out << "collisionResponse CollisionResponse { responseType 2 mass " << body.mass_kg << " restitution "
          << body.restitution << " } ";
    }
    put_parts(out, body);
    out << " }\n";
  }
  for (const Body& body : bodies) {
    if (body.motion != Motion::kPhysics || bodies.size() < 2) continue;
    out << "CollisionInterest { collisionType 1 objectPath \"" << body.name << "\" interests [";
    for (const Body& other : bodies) {
      if (&other != &body) out << " \"" << other.name << '"';
    }
    out << " ] }\n";
  }
  out << sensors;
  return out.str();
}

std::string LastingScene::scenario(bool one_owner) const {
  std::ostringstream out = exact();
  out << "world = \"world.wrl\"\nduration_s = " << duration_s << "\nsample_hz = " << tick_hz
      << "\nseed = " << seed % 100'000 << "\n[replication]\ntick_hz = " << tick_hz << "\napproach = \"" << approach
      << "\"\n[decisions]\npolicy = \"" << policy << "\"\n";
  if (policy == "server") out << "server = \"" << peers[std::size_t(server)].name << "\"\n";
  out << "[network]\nlatency_ms = " << latency_ms << "\njitter_ms = " << jitter_ms << "\nloss = " << loss << '\n';
  for (std::size_t p = 0; p < peers.size(); ++p) {
    out << "[peer." << peers[p].name << "]\nid = " << peers[p].id << "\nowns = [";
    const char* between = "";
    for (const Body& body : bodies) {
      if (body.owner < 0 || (one_owner ? 0 : body.owner) != int(p)) continue;
      out << between << '"' << body.name << '"';
      between = ", ";
    }
    out << "]\n";
    if (peers[p].tick_hz != 0) out << "tick_hz = " << peers[p].tick_hz << '\n';
    if (have_views) {
      out << "[peer." << peers[p].name << ".viewpoint]\nposition = [" << 3.0 * double(p) << ", 2, 12]\n";
    }
  }
  for (const Body& body : bodies) {
    if (body.motion == Motion::kStands) continue;
    out << "[motion." << body.name << "]\n";
    put_motion(out, body);
  }
  if (late_s > 0.0) {
    out << "[event.late]\nkind = \"join\"\nat_s = " << late_s << "\npeer = \"" << peers.back().name << "\"\n";
  }
  // Who asks for what happens: of one owner's scene all is its own.
  std::string asked = events;
  for (std::size_t at = 0; (at = asked.find("OWNER:", at)) != std::string::npos;) {
    const std::size_t end = asked.find('"', at);
    const std::string name = asked.substr(at + 6, end - at - 6);
    asked.replace(at, end - at, one_owner ? peers[0].name : name);
  }
  out << asked;
  return out.str();
}

std::string LastingScene::text() const {
  std::ostringstream out;
  out << kind << ", " << owners << " owners, ids";
  for (const Peer& peer : peers) out << ' ' << peer.name << '=' << peer.id;
  out << ", " << policy;
  if (policy == "server") out << ' ' << peers[std::size_t(server)].name;
  out << ", " << approach << ", " << latency_ms << " ms, loss " << loss << ", jitter " << jitter_ms << " ms, "
      << tick_hz << " Hz, threshold " << threshold_m;
  if (late_s > 0.0) out << ", late at " << late_s << " s";
  for (const double at_s : inputs_s) out << ", input at " << at_s << " s";
  if (!removed.empty()) out << ", " << removed << " removed";
  for (const Body& b : bodies) {
    out << ", " << b.name << " of " << (b.owner < 0 ? "nobody" : peers[std::size_t(b.owner)].name);
    if (b.motion == Motion::kPhysics) out << " (" << b.mass_kg << " kg, e " << b.restitution << ')';
    if (b.motion == Motion::kDriven) out << " (driven)";
  }
  return out.str();
}

}  // namespace peerd::sim::lasting_scenes
