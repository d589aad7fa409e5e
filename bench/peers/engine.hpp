#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "bench/peers/meshes.hpp"

namespace peerd::bench::peers {

// One way to ask which triangles of two bodies touch. Bodies are copies of one mesh.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual void build(const TriangleMesh& mesh) = 0;           // what all bodies share
  virtual void make_bodies(std::size_t count) = 0;            // what each has of its own
  virtual void move(std::span<const Placement> bodies) = 0;   // all of them, once a frame
  virtual bool first(std::size_t a, std::size_t b) = 0;       // does anything touch?
  virtual std::size_t all(std::size_t a, std::size_t b) = 0;  // how many pairs of triangles
};

enum class Pairs {
  kNone,    // all() is not to be called
  kMerged,  // fewer than there are
  kAll,
};

struct EngineKind {
  const char* name;
  Pairs pairs;
  std::unique_ptr<Engine> (*make)();
};

[[nodiscard]] EngineKind peerd_engine();
[[nodiscard]] EngineKind peerd_lazily();  // builds nothing but what queries come to
[[nodiscard]] EngineKind fcl_obb();       // as Debian has compiled it
[[nodiscard]] EngineKind fcl_obbrss();    // "
[[nodiscard]] EngineKind fcl_obb_float();
[[nodiscard]] EngineKind fcl_kdop18_float_refit();
[[nodiscard]] EngineKind ode();
[[nodiscard]] EngineKind cgal_rigid();
[[nodiscard]] EngineKind pqp();       // where it is installed: BENCH_PEERS_HAS_PQP
[[nodiscard]] EngineKind coal_obb();  // where it is installed: BENCH_PEERS_HAS_COAL
[[nodiscard]] EngineKind coal_obbrss();

}  // namespace peerd::bench::peers
