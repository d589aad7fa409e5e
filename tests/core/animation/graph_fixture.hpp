#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/animation/delivery_log.hpp"
#include "core/animation/event_graph.hpp"
#include "core/animation/sensor_simulator.hpp"

namespace peerd::animation {

// A GraphFixture holds the parts below an Animation, for tests of those above them.
struct GraphFixture {
  explicit GraphFixture(const Network& network)
      : graph(network), simulator(graph, network, 0.0, std::size_t{1} << 20, std::size_t{1} << 10) {
    deliveries.grow(graph.ports.size());
  }
  [[nodiscard]] std::uint32_t port(std::uint32_t node, std::string_view field) const {
    return graph.find(node, field).value();
  }

  EventGraph graph;
  SensorSimulator simulator;
  DeliveryLog deliveries;
};

// Node 0, a sensor that runs from 2 s to 6 s, drives node 2 through the position interpolator 1. Field `x` of node 3
// leads to `x` of node 4, and is not driven.
inline Network sensor_and_relay() {
  return {{TimeSensorFields{4, true, false, 2, 0},
           Interpolator{InterpolatorType::kPosition, std::vector<float>{0, 1}, std::vector<float>{0, 0, 0, 8, 0, 0}},
           PlainNode{}, PlainNode{}, PlainNode{}},
          {{0, "fraction_changed", 1, "set_fraction", FieldType::kFloat},
           {1, "value_changed", 2, "translation", FieldType::kVec3},
           {3, "x", 4, "x", FieldType::kFloat}}};
}

}  // namespace peerd::animation
