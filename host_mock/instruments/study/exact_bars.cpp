// SPDX-License-Identifier: BSD-3-Clause
#include "study/exact_parts.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {
namespace {

using nlohmann::json;

struct Bar {
  double start, length, young, density, section, velocity;
  double wave_speed() const { return std::sqrt(young / density); }
  double impedance() const { return section * std::sqrt(young * density); }
  double mass() const { return density * section * length; }
};

Bar bar_of(const json& bar) {
  return {bar.value("start", 0.0),      bar["length"].get<double>(), bar["young"].get<double>(),
          bar["density"].get<double>(), bar.value("section", 1.0),   bar.value("velocity", 0.0)};
}

}  // namespace

// Contact for the return time 2L/c of a wave, at rest, then rebound at the speed of impact (Doyen
// et al. 2011).
ExactNode bar_on_wall(const Scene& scene) {
  const std::string wanted = "one bar that flies against a plane, no loads";
  const OneBody one = one_body(scene, "bars", wanted);
  require(one.loads.empty() && one.interface.contains("obstacle"), wanted);
  const Bar bar = bar_of(one.body);
  const double gap = bar.start - one.interface["obstacle"]["point"][0].get<double>();
  require(gap >= 0.0 && bar.velocity < 0.0, "a bar that flies towards the plane");
  const double meets = -gap / bar.velocity, leaves = meets + 2.0 * bar.length / bar.wave_speed();
  ExactNode node = piecewise({meets, leaves}, {bar.velocity, 0.0, -bar.velocity});
  node.instants.first_impulse = meets;
  node.instants.last_impulse = leaves;
  const double force = -bar.impedance() * bar.velocity;
  node.impulse = [=](double time) { return force * (std::clamp(time, meets, leaves) - meets); };
  node.work = [](double /*time*/) { return 0.0; };
  node.energy = 0.5 * bar.mass() * bar.velocity * bar.velocity;
  return node;
}

// While no wave has come back both ends move at (Z_A v_A + Z_B v_B)/(Z_A + Z_B). With equal
// impedances the shorter bar is then at rest relative to the longer one's initial speed, and so is
// the longer one's end, until its own wave is back.
std::vector<ExactNode> two_bars(const Scene& scene) {
  require(scene.source["model"]["type"] == "bars" && scene.source["model"]["bars"].size() == 2 &&
              scene.source.value("loads", json::array()).empty() && scene.output.watch.size() == 2,
          "two bars, no loads, and both ends watched, that of the right bar first");
  const json& bars = scene.source["model"]["bars"];
  const Bar a = bar_of(bars[0]), b = bar_of(bars[1]);
  const double gap = b.start - (a.start + a.length);
  require(gap >= 0.0 && a.velocity > b.velocity, "a left bar that catches up with the right one");
  const double meets = gap / (a.velocity - b.velocity);
  const double back_a = 2.0 * a.length / a.wave_speed(), back_b = 2.0 * b.length / b.wave_speed();
  const double together =
      (a.impedance() * a.velocity + b.impedance() * b.velocity) / (a.impedance() + b.impedance());
  const double end = scene.dt * static_cast<double>(scene.steps),
               first_back = meets + std::min(back_a, back_b);
  const bool equal = std::abs(a.impedance() - b.impedance()) <= 1e-12 * a.impedance() && back_a <= back_b;
  require(end <= first_back || (equal && end <= meets + std::max(back_a, back_b)),
          "an end before the first wave comes back, or a shorter left bar of equal impedance and an end "
          "before the "
          "second does");
  const auto node = [&](double before) {
    ExactNode exact = piecewise({meets, first_back}, {before, together, b.velocity});
    exact.instants.first_impulse = meets;
    return exact;
  };
  std::vector<ExactNode> nodes{node(b.velocity), node(a.velocity)};
  const double force = b.impedance() * (together - b.velocity);
  nodes[0].impulse = [=](double time) { return force * (std::clamp(time, meets, first_back) - meets); };
  nodes[0].work = [](double /*time*/) { return 0.0; };
  nodes[0].energy = 0.5 * (a.mass() * a.velocity * a.velocity + b.mass() * b.velocity * b.velocity);
  return nodes;
}

// The glue feels 2F from L/c on; it breaks R_Y/(2F) later if its window is longer, and the end then
// moves at 2F/Z until the next reflection at 3L/c.
ExactNode glued_bar(const Scene& scene) {
  const std::string wanted =
      "one bar, glued on the left by law 'postit' with initial_adhesion and memory, pulled at "
      "its right end by a constant force";
  const auto [model, body, interface, loads, parameters] = one_body(scene, "bars", wanted);
  require(loads.size() == 1 && loads[0]["type"] == "force" && loads[0]["history"].size() == 1 &&
              interface["law"] == "postit",
          wanted);
  require(parameters.contains("initial_adhesion") && parameters.value("memory", json(0.0)).is_number(),
          wanted);
  const Bar bar = bar_of(body);
  const double force = loads[0]["history"][0][1].get<double>() * loads[0]["direction"][0].get<double>();
  const double adhesion = parameters["initial_adhesion"].get<double>() * bar.section;
  const double arrives = bar.length / bar.wave_speed(), breaks = arrives + adhesion / (2.0 * force);
  require(force > 0.0 && parameters["memory"].get<double>() > adhesion / (2.0 * force) &&
              breaks < 3.0 * arrives && scene.dt * static_cast<double>(scene.steps) <= 3.0 * arrives,
          "a window longer than R_Y/(2F), and an end before the next reflection at 3L/c");
  ExactNode node = piecewise({breaks}, {0.0, 2.0 * force / bar.impedance()});
  node.instants.last_rupture = breaks;
  node.impulse = [=](double time) { return -2.0 * force * (std::clamp(time, arrives, breaks) - arrives); };
  node.work = [](double /*time*/) { return 0.0; };
  node.energy = 2.0 * force * force * bar.length / (bar.young * bar.section);  // the load's work up to 2L/c
  return node;
}

// A bar dropped on a plane, which it leaves as a whole after 2L/c: undeformed before the first impact,
// compressed by twice its weight after it, and undeformed again after the second if the flight between
// took a whole number of its vibrations, which then bring its end back (bouncing_bar.json).
ExactNode bouncing_bar(const Scene& scene) {
  const std::string wanted = "one bar at rest, undeformed and under gravity, above a plane";
  const auto [model, body, interface, loads, parameters] = one_body(scene, "bars", wanted);
  require(loads.size() == 1 && loads[0]["type"] == "gravity" && !loads[0].contains("nodes"), wanted);
  require(interface.contains("obstacle") && scene.model->initial_displacement().isZero(0.0), wanted);
  const Bar bar = bar_of(body);
  const double g = -loads[0]["acceleration"][0].get<double>(),
               height = bar.start - interface["obstacle"]["point"][0].get<double>();
  require(g > 0.0 && height > 0.0 && bar.velocity == 0.0, wanted);
  const double fall = std::sqrt(2.0 * height / g), stay = 2.0 * bar.length / bar.wave_speed(),
               vibrations = 2.0 * fall / stay;
  require(std::abs(vibrations - std::round(vibrations)) <= 1e-9 * vibrations && vibrations > 1.5,
          "a flight of 2 sqrt(2 h/g) that is a multiple of the vibration's period 2L/c, by 2 at least");

  // Position above the plane and velocity, s after a start upwards at the speed of the fall.
  const auto thrown = [=](double s) { return Motion1D{g * s * (fall - 0.5 * s), g * (fall - s)}; };
  const auto position = [=](double time) -> Motion1D {
    double s = std::fmod(time, 4.0 * fall + 2.0 * stay);
    if (s < fall) return thrown(s + fall);
    if ((s -= fall) < stay) return {0.0, 0.0};
    if ((s -= stay) < 2.0 * fall) {
      const double r = std::fmod(s, stay);  // of the vibration
      const auto [height_above, velocity] = thrown(s);
      return {height_above - g * r * (stay - r), velocity - g * (stay - 2.0 * r)};
    }
    if ((s -= 2.0 * fall) < stay) return {0.0, 0.0};
    return thrown(s - stay);
  };
  ExactNode node = node_of([=](double time) {
    const Motion1D now = position(time);
    return Motion1D{now.displacement - height, now.velocity};
  });
  node.instants.first_impulse = fall;
  return node;
}

// A rod stretched by a over its length, let go, its far end held: it falls at c a/L, rests on the plane
// while the waves cross, and is thrown back to where it was, each for L/c.
ExactNode held_rod(const Scene& scene) {
  const std::string wanted =
      "one bar at rest, stretched away from a plane at its left end, its right end held, no other load";
  const auto [model, body, interface, loads, parameters] = one_body(scene, "bars", wanted);
  require(loads.size() == 1 && loads[0]["type"] == "motion" &&
              scene.loads[0]->prescribed_nodes().size() == 1 && !loads[0].contains("velocity") &&
              !loads[0].contains("path"),
          wanted);
  const Bar bar = bar_of(body);
  const Dofs& start = scene.model->initial_displacement();
  const Eigen::Index right = start.size() - 1;
  const double a = start[0];
  require(scene.loads[0]->prescribed_nodes()[0] == right && start[right] == 0.0 && a > 0.0 &&
              (start - Dofs::LinSpaced(start.size(), a, 0.0)).cwiseAbs().maxCoeff() <= 1e-12 * a,
          wanted);
  require(interface.contains("obstacle") && bar.velocity == 0.0 &&
              interface["obstacle"]["point"][0].get<double>() == bar.start,
          wanted);
  const double third = bar.length / bar.wave_speed(), speed = a / third;
  ExactNode node;
  node.displacement = [=](double time) {
    return speed * std::max(std::abs(std::fmod(time, 3.0 * third) - 1.5 * third) - 0.5 * third, 0.0);
  };
  node.velocity = [=](double time) {
    const double s = std::fmod(time, 3.0 * third);
    return s < third ? -speed : s < 2.0 * third ? 0.0 : speed;
  };
  node.instants.first_impulse = third;
  return node;
}

}  // namespace ilaw::host
